//! Finds the variances of two pictures, in their own layers or in files.

use etendue::image::{ColorImage, Picture};

use crate::failure::Failure;
use crate::parsers::VarianceFile;
use crate::pictures;

/// The layers that `etendue render --variance` writes.
const LAYERS: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

/// The variance of the mean for each of two pictures; `None` if no file is given and a picture has
/// no variance layers.
///
/// A picture with variance layers needs no file. Two files replace the layers of both pictures.
pub(crate) fn find(
    pictures: &[Picture; 2],
    files: &[VarianceFile],
) -> Result<Option<[ColorImage; 2]>, Failure> {
    let [own, own_of_reference] = pictures.each_ref().map(own_layers);
    match (files, own, own_of_reference) {
        ([], Some(first), Some(second)) => Ok(Some([first, second])),
        ([], ..) => Ok(None),
        ([file], Some(first), None) => Ok(Some([first, read(file)?])),
        ([file], None, Some(second)) => Ok(Some([read(file)?, second])),
        ([_], None, None) => Err(Failure::bad_input(
            "one variance file is not enough: neither picture has `variance` layers \
             (`etendue render --variance` writes them)",
        )),
        ([_], Some(_), Some(_)) => Err(Failure::bad_input(
            "it is unclear which picture the variance file belongs to: both have `variance` layers",
        )),
        ([first, second], ..) => Ok(Some([read(first)?, read(second)?])),
        _ => Err(Failure::bad_input("there are more variance files than pictures")),
    }
}

fn own_layers(picture: &Picture) -> Option<ColorImage> {
    let [red, green, blue] = LAYERS.map(|name| picture.channel(name));
    let color = red?.data.iter().zip(&green?.data).zip(&blue?.data);
    let pixels = color.map(|((&red, &green), &blue)| [red, green, blue]).collect();
    Some(ColorImage { width: picture.width, height: picture.height, pixels })
}

/// Reads the variance of the mean from a file.
fn read(file: &VarianceFile) -> Result<ColorImage, Failure> {
    let picture = pictures::read(&file.path)?;
    let image = own_layers(&picture).map_or_else(|| picture.to_color_image(), Ok);
    let mut image = image.map_err(Failure::bad_input)?;
    let scale = (1.0 / file.count) as f32;
    for pixel in &mut image.pixels {
        *pixel = pixel.map(|value| value * scale);
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(variance: Option<f32>) -> Picture {
        let mut picture = Picture::new(1, 1);
        for name in ["R", "G", "B"] {
            picture.push(name, vec![1.0]);
        }
        for name in LAYERS {
            if let Some(value) = variance {
                picture.push(name, vec![value]);
            }
        }
        picture
    }

    #[test]
    fn own_layers_are_used_by_default() {
        let found = find(&[picture(Some(2.0)), picture(Some(3.0))], &[]).unwrap().unwrap();
        assert_eq!(found.map(|image| image.pixels[0]), [[2.0; 3], [3.0; 3]]);
        assert!(find(&[picture(Some(2.0)), picture(None)], &[]).unwrap().is_none());
    }

    #[test]
    fn ambiguity_is_an_error() {
        let file = VarianceFile { path: "missing.exr".into(), count: 1.0 };
        let files = [file.clone(), file.clone(), file];
        for (first, second) in [(None, None), (Some(1.0), Some(1.0))] {
            assert!(find(&[picture(first), picture(second)], &files[..1]).is_err());
        }
        assert!(find(&[picture(None), picture(None)], &files).is_err());
    }
}
