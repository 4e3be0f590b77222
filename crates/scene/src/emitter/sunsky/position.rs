//! The sun's position by time and place: Blanco-Muriel, Alarcón-Padilla, López-Moratalla and
//! Lara-Coira, "Computing the Solar Vector", Solar Energy 70 (5), 2001.

use glam::DVec3;
use std::f64::consts::PI;

/// An observer's location.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Degrees north.
    pub(super) latitude: f64,
    /// Degrees east.
    pub(super) longitude: f64,
    /// Offset from universal time in hours.
    pub(super) timezone: f64,
}

/// Local date and time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) year: i64,
    pub(super) month: i64,
    pub(super) day: i64,
    pub(super) hour: f64,
    pub(super) minute: f64,
    pub(super) second: f64,
}

/// The Earth's mean radius over its distance from the sun.
const PARALLAX: f64 = 6371.01 / 149_597_890.0;

impl Moment {
    /// The hour in universal time; may lie outside the day.
    fn universal_hours(&self, timezone: f64) -> f64 {
        self.hour - timezone + (self.minute + self.second / 60.0) / 60.0
    }

    /// Days since noon on 1 January 2000, universal time.
    fn elapsed_days(&self, timezone: f64) -> f64 {
        let shifted = (self.month - 14) / 12;
        let julian_day = (1461 * (self.year + 4800 + shifted)) / 4
            + (367 * (self.month - 2 - 12 * shifted)) / 12
            - (3 * ((self.year + 4900 + shifted) / 100)) / 4
            + self.day
            - 32075;
        julian_day as f64 - 0.5 + self.universal_hours(timezone) / 24.0 - 2_451_545.0
    }
}

/// The unit direction towards the sun. z is up; the azimuth counts from the south, as in Mitsuba's
/// `sunsky`.
pub(super) fn direction(moment: &Moment, place: &Place) -> DVec3 {
    let days = moment.elapsed_days(place.timezone);
    // Ecliptic coordinates.
    let omega = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063 + 0.017_202_791_698 * days;
    let anomaly = 6.240_06 + 0.017_201_969_9 * days;
    let longitude =
        mean_longitude + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
            - 0.000_113_4
            - 0.000_020_3 * omega.sin();
    let obliquity = 0.409_092_8 - 6.214e-9 * days + 0.000_039_6 * omega.cos();
    // Celestial coordinates.
    let right_ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    let declination = (obliquity.sin() * longitude.sin()).clamp(-1.0, 1.0).asin();
    // Local coordinates.
    let greenwich_hours =
        6.697_424_324_2 + 0.065_709_828_3 * days + moment.universal_hours(place.timezone);
    let hour_angle = (greenwich_hours * 15.0 + place.longitude).to_radians() - right_ascension;
    let (sin_latitude, cos_latitude) = place.latitude.to_radians().sin_cos();
    let cos_zenith =
        cos_latitude * hour_angle.cos() * declination.cos() + declination.sin() * sin_latitude;
    let zenith = cos_zenith.clamp(-1.0, 1.0).acos();
    let azimuth = (-hour_angle.sin())
        .atan2(declination.tan() * cos_latitude - sin_latitude * hour_angle.cos());
    let zenith = zenith + PARALLAX * zenith.sin();
    let (sin_azimuth, cos_azimuth) = (azimuth - PI).sin_cos();
    DVec3::new(zenith.sin() * cos_azimuth, zenith.sin() * sin_azimuth, zenith.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from Mitsuba 3.9.1. It counts the days since 2000 in single precision, whose steps of
    /// 2⁻¹¹ days move the sun by 0.003.
    #[test]
    fn the_sun_stands_where_mitsuba_has_it() {
        let tokyo = Place { latitude: 35.6894, longitude: 139.6917, timezone: 9.0 };
        let july = Moment { year: 2010, month: 7, day: 10, hour: 15.0, minute: 0.0, second: 0.0 };
        let munich = Place { latitude: 48.0, longitude: 11.0, timezone: 1.0 };
        let march = Moment { year: 2024, month: 3, day: 5, hour: 9.5, minute: 12.0, second: 30.0 };
        let cases = [
            (july, tokyo, DVec3::new(0.051_385_45, 0.691_747_96, 0.720_308_48)),
            (march, munich, DVec3::new(0.624_184_47, -0.655_646_78, 0.424_877_69)),
        ];
        for (moment, place, expected) in cases {
            let found = direction(&moment, &place);
            assert!((found - expected).length() < 3e-3, "{found}: {expected}");
            assert!((found.length() - 1.0).abs() < 1e-12);
        }
    }

    /// In Greenwich at the equinox of 2024 (20 March, 3:06), the sun culminates in the south near
    /// noon, at an elevation of 90° less the latitude.
    #[test]
    fn at_the_equinox_the_noon_sun_is_as_high_as_the_latitude_says() {
        let greenwich = Place { latitude: 51.48, longitude: 0.0, timezone: 0.0 };
        let noon = Moment { year: 2024, month: 3, day: 20, hour: 12.0, minute: 7.5, second: 0.0 };
        let found = direction(&noon, &greenwich);
        assert!((found.z.asin().to_degrees() - 38.52).abs() < 0.2, "{found}");
        assert!(found.y.abs() < 0.01 && found.x > 0.0, "{found}");
    }
}
