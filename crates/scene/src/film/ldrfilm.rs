//! `ldrfilm`: an 8-bit image for displays.

use super::{
    BANNER, CROP_HEIGHT, CROP_OFFSET_X, CROP_OFFSET_Y, CROP_WIDTH, Display, FILTER, FilmSpec,
    HEIGHT, HIGH_QUALITY_EDGES, PixelFormat, SAMPLE_BORDER, WIDTH, keyword, read_common,
};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_image::{FileFormat, ToneMap};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A film that is written as PNG or JPEG, sRGB encoded. From Mitsuba 0.6; what is \
              brighter than white is lost, so prefer `hdrfilm` and convert afterwards.",
    parameters: &[
        WIDTH,
        HEIGHT,
        parameter("file_format", "string", "png", "`png` or `jpeg` (`jpg`)."),
        parameter(
            "pixel_format",
            "string",
            "rgb",
            "`luminance`, `luminance_alpha`, `rgb` or `rgba`; JPEG files hold no alpha.",
        ),
        parameter(
            "tonemap_method",
            "string",
            "gamma",
            "`gamma`: exposure alone. `reinhard` is replaced by a filmic curve, with a warning.",
        ),
        parameter(
            "gamma",
            "float",
            "-1",
            "-1 is the sRGB curve; any other exponent is replaced by it, with a warning.",
        ),
        parameter("exposure", "float", "0", "In stops: values are multiplied by 2^exposure."),
        parameter("key", "float", "0.18", "Of `reinhard`: accepted and without effect."),
        parameter("burn", "float", "0", "Of `reinhard`: accepted and without effect."),
        CROP_OFFSET_X,
        CROP_OFFSET_Y,
        CROP_WIDTH,
        CROP_HEIGHT,
        SAMPLE_BORDER,
        HIGH_QUALITY_EDGES,
        BANNER,
        FILTER,
    ],
    sample: r#"<film type="ldrfilm">
    <integer name="width" value="640"/>
    <integer name="height" value="480"/>
    <float name="exposure" value="1"/>
</film>"#,
};

const FILE_FORMATS: [(&str, FileFormat); 3] =
    [("png", FileFormat::Png), ("jpeg", FileFormat::Jpeg), ("jpg", FileFormat::Jpeg)];

/// The second name of luminance with alpha is that of version 0.6.
const PIXEL_FORMATS: [(&str, PixelFormat); 5] = [
    ("luminance", PixelFormat::Luminance),
    ("luminance_alpha", PixelFormat::LuminanceAlpha),
    ("luminanceAlpha", PixelFormat::LuminanceAlpha),
    ("rgb", PixelFormat::Rgb),
    ("rgba", PixelFormat::Rgba),
];

/// The greatest exposure in stops. More would overflow or underflow.
const MAX_STOPS: f64 = 100.0;

/// Reads the film.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<FilmSpec> {
    let file_format = keyword(parameters, "file_format", FileFormat::Png, &FILE_FORMATS);
    let pixel_format = keyword(parameters, "pixel_format", PixelFormat::Rgb, &PIXEL_FORMATS);
    Some(FilmSpec {
        file_format,
        pixel_format: fit_pixel_format(parameters, file_format, pixel_format),
        display: read_display(parameters),
        ..read_common(parameters)?
    })
}

fn fit_pixel_format(
    parameters: &Parameters<'_>,
    file: FileFormat,
    pixels: PixelFormat,
) -> PixelFormat {
    if file == FileFormat::Jpeg && pixels.has_alpha() {
        let message = "JPEG files hold no alpha; it is left out";
        parameters.warning(Fault::Approximation, "pixel_format", message);
        return pixels.without_alpha();
    }
    pixels
}

/// Exposure and tone mapping. The files support only the sRGB curve.
fn read_display(parameters: &Parameters<'_>) -> Display {
    let gamma = parameters.float("gamma", -1.0);
    if gamma != -1.0 {
        let message = format!("a gamma of {gamma} is replaced by the sRGB curve");
        parameters.warning(Fault::Approximation, "gamma", message);
    }
    let methods = [("gamma", ToneMap::None), ("reinhard", ToneMap::Filmic)];
    let tone_map = keyword(parameters, "tonemap_method", ToneMap::None, &methods);
    if tone_map != ToneMap::None {
        let message = "Reinhard's tone mapping is replaced by a filmic curve";
        parameters.warning(Fault::Approximation, "tonemap_method", message);
    }
    for without_effect in ["key", "burn"] {
        parameters.optional_float(without_effect);
    }
    let exposure = parameters.float_in("exposure", 0.0, -MAX_STOPS..=MAX_STOPS) as f32;
    Display { exposure, tone_map }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Class;

    fn node() -> TestNode {
        TestNode::new(Class::Film, "ldrfilm")
    }

    #[test]
    fn the_defaults_are_those_of_version_0_6() {
        let film = node().float("gamma", -1.0).float("exposure", 1.5).build_cleanly(build);
        assert_eq!(film.file_format, FileFormat::Png);
        assert_eq!(film.pixel_format, PixelFormat::Rgb);
        assert_eq!(film.display, Display { exposure: 1.5, tone_map: ToneMap::None });
    }

    #[test]
    fn what_is_replaced_is_reported() {
        let cases = [
            ("gamma", node().float("gamma", 2.2)),
            ("reinhard", node().string("tonemap_method", "reinhard").float("key", 0.2)),
            ("alpha", node().string("file_format", "jpg").string("pixel_format", "rgba")),
        ];
        for (name, node) in cases {
            let film = node.build(build).expect("a warning is no error");
            assert_eq!(node.findings().len(), 1, "{name}");
            assert_eq!(node.findings()[0].fault, Fault::Approximation, "{name}");
            assert_eq!(film.pixel_format, PixelFormat::Rgb, "{name}");
        }
    }

    #[test]
    fn hostile_exposures_are_errors() {
        for exposure in [f64::NAN, f64::INFINITY, 1e9] {
            let node = node().float("exposure", exposure);
            node.build(build);
            assert_eq!(node.findings()[0].fault, Fault::BadValue, "{exposure}");
        }
    }
}
