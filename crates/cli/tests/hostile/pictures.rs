//! Broken picture and spectrum files.

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use std::fs;
use std::io::Write;

use crate::case::{Case, Parts};
use crate::run::Workplace;

fn texture(file: &str) -> String {
    format!("<texture type=\"bitmap\"><string name=\"filename\" value=\"{file}\"/></texture>")
}

fn environment(file: &str) -> String {
    format!("<emitter type=\"envmap\"><string name=\"filename\" value=\"{file}\"/></emitter>")
}

/// Checks pictures of one format as textures: the defect, the bytes, and text that the error must
/// contain.
fn check_all<const N: usize>(file: &'static str, rows: [(&str, Vec<u8>, &str); N]) {
    for (defect, bytes, message) in rows {
        Case::file(&texture(file), (file, bytes), defect, message).check();
    }
}

/// A PNG file of 8-bit colours, whose header may lie about its size.
fn png(width: u32, height: u32, rows: &[u8]) -> Vec<u8> {
    let mut compressed = ZlibEncoder::new(Vec::new(), Compression::fast());
    compressed.write_all(rows).unwrap();
    let mut header = [width.to_be_bytes(), height.to_be_bytes()].concat();
    header.extend([8, 2, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    file.extend(png_chunk(*b"IHDR", &header));
    file.extend(png_chunk(*b"IDAT", &compressed.finish().unwrap()));
    file.extend(png_chunk(*b"IEND", &[]));
    file
}

fn png_chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [&kind[..], data].concat();
    let mut checksum = Crc::new();
    checksum.update(&named);
    let length = (data.len() as u32).to_be_bytes();
    [&length[..], &named, &checksum.sum().to_be_bytes()].concat()
}

#[test]
fn broken_png_and_jpeg_files_are_rejected() {
    let whole = png(2, 2, &[0; 14]);
    let bomb = vec![0; 180_001 * 300];
    let rows = [
        ("empty", Vec::new(), "is empty"),
        ("text", b"hello".to_vec(), "none of the picture formats"),
        ("the first 8 bytes", whole[..8].to_vec(), "broken PNG"),
        ("cut off in the header", whole[..20].to_vec(), "broken PNG"),
        ("cut off in the data", whole[..whole.len() - 20].to_vec(), "broken PNG"),
        ("a damaged header", [&whole[..20], &[1; 30]].concat(), "broken PNG"),
        ("no columns", png(0, 5, &[]), "broken PNG"),
        ("a header that announces more", png(500, 500, &[0; 100]), "broken PNG"),
        ("60,000 squared", png(60_000, 60_000, &bomb), "too large"),
        ("2³¹ squared", png(u32::MAX >> 1, u32::MAX >> 1, &[]), "a.png"),
    ];
    check_all("a.png", rows);
    let huge_jpeg = [
        &b"\xff\xd8\xff\xc0\0\x11\x08\xff\xff\xff\xff\x03\x01\x11\0\x02\x11\0\x03\x11\0"[..],
        b"\xff\xda\0\x0c\x03\x01\0\x02\0\x03\0\0\x3f\0",
        &[0; 100],
    ];
    let rows = [
        ("cut off", b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\x01".to_vec(), "broken JPEG"),
        ("65,535 squared", huge_jpeg.concat(), "too large"),
    ];
    check_all("a.jpg", rows);
}

/// A colour PFM file, whose header may lie about its size.
fn pfm(size: &str, values: &[f32]) -> Vec<u8> {
    let mut file = format!("PF\n{size}\n-1.0\n").into_bytes();
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    file
}

#[test]
fn broken_hdr_pfm_tga_and_bmp_files_are_rejected() {
    let rows = [
        ("a header alone", b"#?RADIANCE\n\n-Y 10 +X 10\n".to_vec(), "broken"),
        (
            "100,000 squared",
            b"#?RADIANCE\n\n-Y 100000 +X 100000\n\x02\x02\0\0".to_vec(),
            "too large",
        ),
        ("less than nothing", b"#?RADIANCE\n\n-Y -5 +X 7\n".to_vec(), "broken"),
        ("an endless header", [&b"#?RADIANCE\n"[..], &b"A=b\n".repeat(500_000)].concat(), "broken"),
    ];
    check_all("a.hdr", rows);
    let rows = [
        ("cut off", pfm("10 10", &[0.5]), "the header announces 300 floats, but the file has 1"),
        ("100,000 squared", pfm("100000 100000", &[]), "too large"),
        ("less than nothing", pfm("-1 1", &[]), "width"),
        ("no columns", pfm("0 1", &[]), "width"),
        ("beyond 64 bits", pfm("99999999999999999999999 1", &[]), "width"),
    ];
    check_all("a.pfm", rows);
    let tga = |kind: u8, size: u8| {
        let mut header = [0; 18];
        header[2] = kind;
        header[12..16].fill(size);
        header[16] = 24;
        header.to_vec()
    };
    let rows = [
        ("65,535 squared", tga(2, 255), "too large"),
        ("65,535 squared in runs", tga(10, 255), "too large"),
        ("no pixels", tga(2, 0), "broken TGA"),
        ("text", b"hello there, this is more than eighteen bytes".to_vec(), "TGA"),
    ];
    check_all("a.tga", rows);
    let bmp = |size: [i32; 2]| {
        let numbers = [54, 0, 54, 40, size[0], size[1], 24 << 16 | 1, 0, 0, 0, 0, 0, 0];
        [&b"BM"[..], &numbers.map(i32::to_le_bytes).concat()].concat()
    };
    let rows = [
        ("cut off", b"BM\0\0\0\0".to_vec(), "broken BMP"),
        ("100,000 squared", bmp([100_000, 100_000]), "large"),
        ("negative", bmp([-5, i32::MIN]), "broken BMP"),
    ];
    check_all("a.bmp", rows);
}

/// An uncompressed EXR file of three float channels: the header, then `rest`.
fn exr([width, height]: [i32; 2], compression: u8, rest: &[u8]) -> Vec<u8> {
    let attribute = |name: &str, kind: &str, data: &[u8]| {
        let length = (data.len() as u32).to_le_bytes();
        [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &length, data].concat()
    };
    let channel =
        |name: u8| [&[name, 0, 2, 0, 0, 0][..], &[0; 4], &[1, 0, 0, 0, 1, 0, 0, 0]].concat();
    let channels = [channel(b'B'), channel(b'G'), channel(b'R'), vec![0]].concat();
    let window =
        [0, 0, width.wrapping_sub(1), height.wrapping_sub(1)].map(i32::to_le_bytes).concat();
    let one = 1.0_f32.to_le_bytes();
    [
        &b"v/1\x01\x02\0\0\0"[..],
        &attribute("channels", "chlist", &channels),
        &attribute("compression", "compression", &[compression]),
        &attribute("dataWindow", "box2i", &window),
        &attribute("displayWindow", "box2i", &window),
        &attribute("lineOrder", "lineOrder", &[0]),
        &attribute("pixelAspectRatio", "float", &one),
        &attribute("screenWindowCenter", "v2f", &[0; 8]),
        &attribute("screenWindowWidth", "float", &one),
        b"\0",
        rest,
    ]
    .concat()
}

#[test]
fn broken_exr_files_are_rejected() {
    let zip = 3;
    let rows = [
        ("four bytes", b"v/1\x01".to_vec(), "broken OpenEXR"),
        ("another header", [&b"v/1\x01\x02\0\0\0"[..], &[0xa5; 500]].concat(), "broken OpenEXR"),
        ("a header alone", exr([1, 1], 0, &[]), "OpenEXR"),
        ("30,000 squared", exr([30_000, 30_000], 0, &[]), "OpenEXR"),
        ("60,000 squared, with a table", exr([60_000, 60_000], 0, &vec![0; 480_000]), "too large"),
        ("2³¹ squared", exr([i32::MAX, i32::MAX], 0, &[]), "OpenEXR"),
        ("a window with a negative size", exr([-5, -5], 0, &[0; 100]), "OpenEXR"),
        ("garbage instead of ZIP data", exr([1, 1], zip, &[7; 40]), "OpenEXR"),
    ];
    check_all("a.exr", rows);
}

#[test]
fn environment_maps_with_broken_light_load_with_a_warning() {
    for value in [f32::NAN, f32::INFINITY, -1.0] {
        let workplace = Workplace::new();
        let scene = Parts { content: &environment("a.pfm"), ..Parts::default() }.scene();
        let scene = scene.replace("<emitter type=\"constant\"/>", "");
        fs::write(workplace.path("scene.xml"), scene).unwrap();
        fs::write(workplace.path("a.pfm"), pfm("1 1", &[value; 3])).unwrap();
        let outcome = workplace.succeed(&["render", "scene.xml", "-o", "a.exr"]);
        let expected = format!("a.pfm: texel 0, 0 is {value}, {value}, {value}");
        assert!(outcome.stderr.contains(&expected), "{}", outcome.stderr);
    }
}

#[test]
fn broken_spectrum_files_are_rejected() {
    let content = r#"<bsdf type="diffuse"><spectrum name="reflectance" filename="a.spd"/></bsdf>"#;
    let rows = [
        ("", "is empty"),
        ("hello", "line 1: expected a wavelength and a value"),
        ("# nothing\n", "two samples"),
        ("400 1\n300 1\n", "line 2: the wavelengths do not increase"),
        ("400 nan\n500 1\n", "not finite"),
        ("400\n500\n", "a wavelength in nanometres and a value"),
        ("400 1\n", "two samples"),
    ];
    for (text, message) in rows {
        Case::file(content, ("a.spd", text.into()), text, message).check();
    }
}
