//! `hdrfilm`: linear values in a high-dynamic-range file.

use super::{
    BANNER, CROP_HEIGHT, CROP_OFFSET_X, CROP_OFFSET_Y, CROP_WIDTH, FILTER, FilmSpec, HEIGHT,
    HIGH_QUALITY_EDGES, PixelFormat, SAMPLE_BORDER, WIDTH, keyword, read_common,
};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_image::{ExrPrecision, FileFormat};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A film for linear values of any range: OpenEXR, Radiance HDR or PFM. The default \
              where a scene has no film.",
    parameters: &[
        WIDTH,
        HEIGHT,
        parameter("file_format", "string", "openexr", "`openexr` (`exr`), `rgbe` or `pfm`."),
        parameter(
            "pixel_format",
            "string",
            "rgb",
            "`luminance`, `luminance_alpha`, `rgb`, `rgba`, `xyz` or `xyza`; `rgbe` files hold \
             `rgb` alone, `pfm` files `rgb` or `luminance`.",
        ),
        parameter(
            "component_format",
            "string",
            "float16",
            "The numbers of an OpenEXR file: `float16` or `float32`; `uint32` is written as \
             `float32`.",
        ),
        CROP_OFFSET_X,
        CROP_OFFSET_Y,
        CROP_WIDTH,
        CROP_HEIGHT,
        SAMPLE_BORDER,
        HIGH_QUALITY_EDGES,
        parameter(
            "compensate",
            "boolean",
            "false",
            "Accepted and without effect: sums are kept in double precision.",
        ),
        parameter(
            "attach_log",
            "boolean",
            "true",
            "Accepted and without effect: no log is put into the file.",
        ),
        BANNER,
        FILTER,
    ],
    sample: r#"<film type="hdrfilm">
    <integer name="width" value="1920"/>
    <integer name="height" value="1080"/>
    <string name="pixel_format" value="rgba"/>
    <rfilter type="box"/>
</film>"#,
};

const FILE_FORMATS: [(&str, FileFormat); 4] = [
    ("openexr", FileFormat::Exr),
    ("exr", FileFormat::Exr),
    ("rgbe", FileFormat::Hdr),
    ("pfm", FileFormat::Pfm),
];

/// The second name of luminance with alpha is that of version 0.6.
const PIXEL_FORMATS: [(&str, PixelFormat); 7] = [
    ("luminance", PixelFormat::Luminance),
    ("luminance_alpha", PixelFormat::LuminanceAlpha),
    ("luminanceAlpha", PixelFormat::LuminanceAlpha),
    ("rgb", PixelFormat::Rgb),
    ("rgba", PixelFormat::Rgba),
    ("xyz", PixelFormat::Xyz),
    ("xyza", PixelFormat::Xyza),
];

/// Reads the film.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<FilmSpec> {
    for without_effect in ["compensate", "attach_log"] {
        parameters.optional_boolean(without_effect);
    }
    let file_format = keyword(parameters, "file_format", FileFormat::Exr, &FILE_FORMATS);
    let pixel_format = keyword(parameters, "pixel_format", PixelFormat::Rgb, &PIXEL_FORMATS);
    Some(FilmSpec {
        file_format,
        pixel_format: fit_pixel_format(parameters, file_format, pixel_format),
        component_format: read_component_format(parameters),
        ..read_common(parameters)?
    })
}

/// Reads the number format of the file. Choices of `None` are not supported.
fn read_component_format(parameters: &Parameters<'_>) -> ExrPrecision {
    const CHOICES: [(&str, Option<ExrPrecision>); 3] = [
        ("float16", Some(ExrPrecision::Half)),
        ("float32", Some(ExrPrecision::Float)),
        ("uint32", None),
    ];
    let chosen = keyword(parameters, "component_format", CHOICES[0].1, &CHOICES);
    chosen.unwrap_or_else(|| {
        let message = "whole numbers are not written; the file gets `float32`";
        parameters.warning(Fault::Approximation, "component_format", message);
        ExrPrecision::Float
    })
}

/// The requested channels, reduced to those that the file format supports.
fn fit_pixel_format(
    parameters: &Parameters<'_>,
    file: FileFormat,
    pixels: PixelFormat,
) -> PixelFormat {
    let fitting = match (file, pixels) {
        (FileFormat::Pfm, PixelFormat::Luminance | PixelFormat::LuminanceAlpha) => {
            PixelFormat::Luminance
        }
        (FileFormat::Pfm | FileFormat::Hdr, _) => PixelFormat::Rgb,
        _ => pixels,
    };
    if fitting != pixels {
        let message = format!("this kind of file holds {fitting:?} instead of {pixels:?}");
        parameters.warning(Fault::Approximation, "pixel_format", message);
    }
    fitting
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Class;

    fn node() -> TestNode {
        TestNode::new(Class::Film, "hdrfilm")
    }

    #[test]
    fn the_formats_are_read() {
        let film = node().string("component_format", "float32").string("file_format", "EXR");
        let film = film.string("pixel_format", "luminanceAlpha").build_cleanly(build);
        assert_eq!(film.component_format, ExrPrecision::Float);
        assert_eq!(film.file_format, FileFormat::Exr);
        assert_eq!(film.pixel_format, PixelFormat::LuminanceAlpha);
    }

    #[test]
    fn what_a_file_cannot_hold_is_left_out_with_a_warning() {
        let cases = [
            ("rgbe", "rgba", PixelFormat::Rgb),
            ("rgbe", "luminance", PixelFormat::Rgb),
            ("pfm", "luminance_alpha", PixelFormat::Luminance),
            ("pfm", "xyz", PixelFormat::Rgb),
        ];
        for (file, pixels, expected) in cases {
            let node = node().string("file_format", file).string("pixel_format", pixels);
            assert_eq!(node.build(build).map(|film| film.pixel_format), Some(expected));
            assert_eq!(node.findings()[0].fault, Fault::Approximation, "{file} {pixels}");
        }
        let integers = node().string("component_format", "uint32");
        let film = integers.build(build).expect("a warning is no error");
        assert_eq!(film.component_format, ExrPrecision::Float);
        assert_eq!(integers.findings()[0].fault, Fault::Approximation);
    }
}
