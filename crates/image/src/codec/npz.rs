//! NumPy archives: one array for each layer.

use super::npy::{self, Array};
use super::zip;
use crate::{Bitmap, ImageError, Limits, Picture, PictureHeader};

/// The format's name in messages.
const FORMAT: &str = "NumPy archive";

/// The array of the main layer.
const MAIN: &str = "color";

/// The ending of the arrays' file names.
const ENDING: &str = ".npy";

/// Decodes the array of the main layer, or the first one.
pub(super) fn decode_bitmap(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let mut arrays = read(bytes, limits)?;
    let main = arrays.iter().position(|(name, _)| name == MAIN).unwrap_or(0);
    let (_, array) = arrays.swap_remove(main);
    if array.channels > 4 {
        let message = format!("a picture of {} channels", array.channels);
        return Err(ImageError::unsupported(FORMAT, message));
    }
    Ok(array.into_bitmap())
}

/// The size that the header of the main layer's array announces. All arrays are unpacked to decode it.
pub(super) fn read_header(bytes: &[u8], limits: &Limits) -> Result<PictureHeader, ImageError> {
    let starts = zip::read_starts(bytes, npy::MAX_START)?;
    let main = format!("{MAIN}{ENDING}");
    let first = starts.iter().find(|file| file.name == main).or_else(|| starts.first());
    let first = first.ok_or_else(|| ImageError::malformed(FORMAT, "it has no arrays"))?;
    let header = npy::read_header(&first.start, limits)?;
    let unpacked = starts.iter().map(|file| file.size).fold(0, u64::saturating_add);
    let decoding_bytes = header.decoding_bytes.saturating_add(unpacked.saturating_mul(2));
    Ok(PictureHeader { decoding_bytes, ..header })
}

/// Decodes all arrays. Layers other than the main one are taken as they are, and get the channels
/// `Y`; `X` and `Y`; `R`, `G` and `B`; `R`, `G`, `B` and `A`; or numbers.
pub(super) fn decode_picture(bytes: &[u8], limits: &Limits) -> Result<Picture, ImageError> {
    let arrays = read(bytes, limits)?;
    let (width, height) = (arrays[0].1.width, arrays[0].1.height);
    let is_alone = arrays.len() == 1;
    let mut picture = Picture::new(width, height);
    for (name, array) in arrays {
        if (array.width, array.height) != (width, height) {
            let message = format!("the array `{name}` has another size than the first one");
            return Err(ImageError::unsupported(FORMAT, message));
        }
        let is_main = array.channels <= 4 && (is_alone || name == MAIN);
        let names: Vec<String> = match array.channels {
            _ if is_main => array.channel_names().iter().map(|c| (*c).to_owned()).collect(),
            2 => ["X", "Y"].map(|channel| format!("{name}.{channel}")).into(),
            1 | 3 | 4 => {
                array.channel_names().iter().map(|channel| format!("{name}.{channel}")).collect()
            }
            count => (0..count).map(|channel| format!("{name}.{channel}")).collect(),
        };
        let bitmap = array.into_bitmap();
        let values = if is_main { bitmap.to_linear() } else { bitmap.to_raw() };
        for (index, channel) in names.iter().enumerate() {
            let plane = values.iter().skip(index).step_by(names.len()).copied().collect();
            picture.push(channel, plane);
        }
    }
    picture.validate().map_err(|error| ImageError::malformed(FORMAT, error.to_string()))?;
    Ok(picture)
}

/// Encodes the main layer as the array `color`, and every other layer as an array of its name.
pub(super) fn encode(picture: &Picture) -> Result<Vec<u8>, ImageError> {
    let layers = picture.layers();
    if layers.is_empty() {
        return Err(ImageError::invalid_picture("it has no channels"));
    }
    let arrays: Vec<(String, Vec<u8>)> = layers
        .iter()
        .map(|(name, channels)| {
            let name = if name.is_empty() { MAIN } else { name };
            (format!("{name}{ENDING}"), npy::encode_channels(picture, channels))
        })
        .collect();
    zip::write(&arrays)
}

/// All arrays with their names; at least one.
fn read(bytes: &[u8], limits: &Limits) -> Result<Vec<(String, Array)>, ImageError> {
    let files = zip::read(bytes, limits)?;
    let arrays = files.into_iter().filter_map(|(name, content)| {
        let name = name.strip_suffix(ENDING)?.to_owned();
        Some(npy::decode_array(&content, limits).map(|array| (name, array)))
    });
    let arrays: Vec<_> = arrays.collect::<Result<_, _>>()?;
    if arrays.is_empty() {
        return Err(ImageError::unsupported(FORMAT, "an archive without arrays"));
    }
    Ok(arrays)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decode, decode_picture};

    #[test]
    fn layers_round_trip_as_arrays() {
        let mut picture = Picture::new(3, 2);
        let names = ["R", "G", "B", "A", "normal.X", "normal.Y", "normal.Z", "depth.T"];
        for (channel, name) in names.into_iter().enumerate() {
            picture.push(name, (0..6).map(|index| (index * 10 + channel) as f32).collect());
        }
        let bytes = encode(&picture).unwrap();
        let read = decode_picture(&bytes, "").unwrap();
        let found: Vec<&str> = read.channels.iter().map(|c| c.name.as_str()).collect();
        let expected = ["R", "G", "B", "A", "normal.R", "normal.G", "normal.B", "depth.Y"];
        assert_eq!(found, expected);
        for (read, written) in read.channels.iter().zip(&picture.channels) {
            assert_eq!(read.data, written.data, "{}", read.name);
        }
        assert_eq!(decode(&bytes, "").unwrap().channels, 4);
    }

    #[test]
    fn arrays_of_other_sizes_and_empty_archives_are_errors() {
        let array = |width| {
            let mut picture = Picture::new(width, 1);
            picture.push("Y", vec![0.0; width as usize]);
            npy::encode(&picture).unwrap()
        };
        let of = |files: &[(&str, Vec<u8>)]| {
            let files: Vec<_> =
                files.iter().map(|(name, file)| ((*name).to_owned(), file.clone())).collect();
            decode_picture(&zip::write(&files).unwrap(), "a.npz")
        };
        assert!(of(&[("a.npy", array(1)), ("b.npy", array(2))]).is_err());
        assert!(of(&[("a.npy", array(1)), ("a.npy", array(1))]).is_err());
        assert!(of(&[("a.txt", array(1))]).is_err());
        assert!(of(&[]).is_err());
        assert!(of(&[("a.npy", array(1))]).is_ok());
    }
}
