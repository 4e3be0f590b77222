//! What the fuzz targets do with hostile bytes. Whatever the bytes are, each function must return soon,
//! without a panic and within little memory; its result does not matter.
//!
//! The test that replays findings calls these functions, too
//! (`crates/etendue/tests/fuzz_findings.rs`).
#![allow(dead_code, reason = "every target uses one function")]
#![allow(unexpected_cfgs, reason = "`cargo fuzz` sets `fuzzing`")]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use etendue::document::{Diagnostics, MemoryResources};
use etendue::engine::Channels;
use etendue::image::{Limits, decode_exr_layers_with_limits, decode_with_limits};
use etendue::mesh::{ObjOptions, read_obj, read_ply, read_serialized, serialized_shape_count};
use etendue::mitsuba::{LoadOptions, read_file, read_text};
use etendue::scene::BuildOptions;
use etendue::{
    Cancel, FilmFile, RenderJob, RenderOptions, SceneOptions, Silent, Workers, load_text,
};

/// Reads bytes.
pub(crate) type Target = fn(&[u8]);

/// Every target, with the name of its folder of seeds.
pub(crate) const ALL: &[(&str, Target)] = &[
    ("xml", xml),
    ("obj", obj),
    ("ply", ply),
    ("serialized", serialized),
    ("vol", vol),
    ("checkpoint", checkpoint),
    ("exr", exr),
    ("png", png),
    ("jpeg", jpeg),
    ("hdr", hdr),
    ("bmp", bmp),
    ("tga", tga),
    ("tiff", tiff),
    ("pfm", pfm),
    ("scene", scene),
];

/// Limits for pictures: enough to reach all code, and little enough to be quick.
const LIMITS: Limits = Limits { samples: 1 << 20, bytes: 4 << 20 };

/// The memory limit for film sums.
const SUMS_LIMIT: u64 = 64 << 20;

/// Reads a scene into a document, as a file of any encoding and as text.
pub(crate) fn xml(bytes: &[u8]) {
    let resources = MemoryResources::default().with("/scene.xml", bytes);
    let options = LoadOptions::default();
    let _ = read_file(Path::new("/scene.xml"), &resources, &options, &Diagnostics::new());
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = read_text(text, &resources, &options, &Diagnostics::new());
    }
}

/// A mesh in Wavefront's format.
pub(crate) fn obj(bytes: &[u8]) {
    let _ = read_obj(bytes, &ObjOptions::default());
}

/// A mesh in Stanford's format.
pub(crate) fn ply(bytes: &[u8]) {
    let _ = read_ply(bytes);
}

/// Meshes in Mitsuba's format.
pub(crate) fn serialized(bytes: &[u8]) {
    let count = serialized_shape_count(bytes).unwrap_or(0);
    for index in 0..count.min(4) {
        let _ = read_serialized(bytes, index);
    }
}

/// A volume on a grid, as the density of a medium.
pub(crate) fn vol(bytes: &[u8]) {
    const SCENE: &str = r#"<scene version="3.0.0">
        <integrator type="volpath"><integer name="max_depth" value="4"/></integrator>
        <sensor type="perspective">
            <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        </sensor>
        <emitter type="constant"/>
        <shape type="cube">
            <bsdf type="null"/>
            <medium type="heterogeneous" name="interior">
                <volume type="gridvolume" name="sigma_t"><string name="filename" value="a.vol"/></volume>
            </medium>
        </shape>
    </scene>"#;
    build_and_render(SCENE, &MemoryResources::default().with("/a.vol", bytes));
}

/// A checkpoint or part, as it is and with a corrected checksum.
pub(crate) fn checkpoint(bytes: &[u8]) {
    read_checkpoint(bytes);
    let content = &bytes[..bytes.len().saturating_sub(blake3::OUT_LEN)];
    let checksum = blake3::hash(content);
    read_checkpoint(&[content, checksum.as_bytes()].concat());
}

/// Reads sums and treats them as `merge` does.
fn read_checkpoint(bytes: &[u8]) {
    let read = |bytes: &[u8]| {
        let mut input = bytes;
        let file = FilmFile::read_header(&mut input).ok()?;
        let film = file.read_sums(&mut input, bytes.len() as u64, SUMS_LIMIT).ok()?;
        Some((file, film))
    };
    let Some((file, mut film)) = read(bytes) else { return };
    film.develop(Channels { alpha: true, variance: true });
    let mut again = Vec::new();
    film.write(&file.record, &mut again).expect("a vector accepts every byte");
    let (_, other) = read(&again).expect("what is written can be read");
    let _ = film.merge(&other);
    film.develop(Channels { alpha: true, variance: true });
}

/// An OpenEXR file, as a picture and as layers. Panics of the `exr` crate are caught by ours.
pub(crate) fn exr(bytes: &[u8]) {
    // The fuzzer's hook would abort at panics that are caught. Uncaught ones still end the process.
    #[cfg(fuzzing)]
    std::panic::set_hook(Box::new(|_| {}));
    let _ = decode_exr_layers_with_limits(bytes, &LIMITS);
    let _ = decode_with_limits(bytes, "a.exr", &LIMITS);
}

/// A PNG file.
pub(crate) fn png(bytes: &[u8]) {
    decode_starting(b"\x89PNG\r\n\x1a\n", bytes, "a.png");
}

/// A JPEG file.
pub(crate) fn jpeg(bytes: &[u8]) {
    decode_starting(b"\xff\xd8\xff", bytes, "a.jpg");
}

/// A Radiance HDR file.
pub(crate) fn hdr(bytes: &[u8]) {
    decode_starting(b"#?RADIANCE\n", bytes, "a.hdr");
}

/// A Windows bitmap.
pub(crate) fn bmp(bytes: &[u8]) {
    decode_starting(b"BM", bytes, "a.bmp");
}

/// A Targa file, which is recognised by its name alone.
pub(crate) fn tga(bytes: &[u8]) {
    let _ = decode_with_limits(bytes, "a.tga", &LIMITS);
}

/// A TIFF file of either byte order.
pub(crate) fn tiff(bytes: &[u8]) {
    decode_starting(b"II*\0", bytes, "a.tif");
    decode_starting(b"MM\0*", bytes, "a.tif");
}

/// A portable float map.
pub(crate) fn pfm(bytes: &[u8]) {
    decode_starting(b"PF\n", bytes, "a.pfm");
}

/// The first bytes choose the decoder: they are prepended where they are missing.
fn decode_starting(start: &[u8], bytes: &[u8], name: &str) {
    if bytes.starts_with(start) {
        let _ = decode_with_limits(bytes, name, &LIMITS);
    } else {
        let _ = decode_with_limits(&[start, bytes].concat(), name, &LIMITS);
    }
}

/// Builds a scene from text and renders a few pixels.
pub(crate) fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    static FILES: LazyLock<MemoryResources> = LazyLock::new(|| {
        MemoryResources::default()
            .with(
                "/a.obj",
                &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"[..],
            )
            .with(
                "/a.pfm",
                &b"PF\n2 1\n-1.0\n\0\0\x80\x3f\0\0\0\x3f\0\0\x80\x3e\0\0\0\x40\0\0\x80\x3f\0\0\0\0"
                    [..],
            )
    });
    build_and_render(text, &FILES);
}

/// Builds a scene from text and renders six pixels with one sample each.
fn build_and_render(text: &str, files: &MemoryResources) {
    static WORKERS: LazyLock<Workers> = LazyLock::new(|| {
        Workers::new(std::num::NonZeroUsize::new(1)).expect("one thread can be started")
    });
    let options = SceneOptions {
        build: BuildOptions { film_size: Some([3, 2]), ..BuildOptions::default() },
        ..SceneOptions::default()
    };
    let loaded = WORKERS.run(|| load_text(text, PathBuf::from("/"), files, &options));
    let Some(scene) = loaded.scene else { return };
    let options = RenderOptions {
        samples_per_pixel: Some(1),
        memory_limit: Some(SUMS_LIMIT),
        ..RenderOptions::default()
    };
    if let Ok(job) = RenderJob::new(&scene, &options) {
        let _ = job.render(&WORKERS, &Silent, &Cancel::new());
    }
}
