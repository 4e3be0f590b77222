//! Embree 4 through its C interface, loaded at run time.

use crate::Tracer;
use crate::obj::Mesh;
use etendue_math::Ray;
use libloading::{Library, Symbol};
use std::error::Error;
use std::ffi::{CString, c_char, c_void};
use std::mem::ManuallyDrop;

/// Instruction set, flags and build quality of a scene.
pub(crate) struct Variant {
    name: &'static str,
    device: &'static str,
    flags: i32,
    quality: i32,
}

const ROBUST: i32 = 1 << 2;
const MEDIUM: i32 = 1;

/// What we compare with; the first is what ratios refer to.
pub(crate) const VARIANTS: [&Variant; 3] = [
    &Variant { name: "avx2", device: "threads=1,isa=avx2", flags: 0, quality: MEDIUM },
    &Variant { name: "avx512", device: "threads=1", flags: 0, quality: MEDIUM },
    &Variant { name: "avx2 robust", device: "threads=1,isa=avx2", flags: ROBUST, quality: MEDIUM },
];

type Handle = *mut c_void;

/// RTCRay, then RTCHit in the last words.
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instance: [u32; 5],
}

impl RayHit {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: u32::MAX,
            geometry: u32::MAX,
            instance: [u32::MAX; 5],
        }
    }
}

type Trace = unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void);

/// A committed scene.
pub(crate) struct Scene {
    name: &'static str,
    scene: Handle,
    intersect: Trace,
    occluded: Trace,
    // Unloading Embree or the thread library below it crashes at exit.
    _library: ManuallyDrop<Library>,
}

impl Scene {
    pub(crate) fn build(
        path: &str,
        variant: &Variant,
        meshes: &[Mesh],
    ) -> Result<Self, Box<dyn Error>> {
        // SAFETY: the library is Embree 4, whose C interface these signatures are, and it stays
        // loaded; buffers are filled within the sizes that they were made with.
        unsafe {
            let library = ManuallyDrop::new(Library::new(path)?);
            let new_device: Symbol<unsafe extern "C" fn(*const c_char) -> Handle> =
                library.get(b"rtcNewDevice\0")?;
            let from_handle = |name: &[u8]| {
                library.get::<unsafe extern "C" fn(Handle) -> Handle>(name).map(|symbol| *symbol)
            };
            let set = |name: &[u8]| {
                library.get::<unsafe extern "C" fn(Handle, i32)>(name).map(|symbol| *symbol)
            };
            let device = new_device(CString::new(variant.device)?.as_ptr());
            let scene = from_handle(b"rtcNewScene\0")?(device);
            set(b"rtcSetSceneFlags\0")?(scene, variant.flags);
            set(b"rtcSetSceneBuildQuality\0")?(scene, variant.quality);
            for mesh in meshes {
                attach(&library, device, scene, mesh)?;
            }
            let start = crate::workload::thread_seconds();
            from_handle(b"rtcCommitScene\0")?(scene);
            let seconds = crate::workload::thread_seconds() - start;
            println!("embree {}: build {seconds:.3} s on one thread", variant.name);
            let intersect = *library.get::<Trace>(b"rtcIntersect1\0")?;
            let occluded = *library.get::<Trace>(b"rtcOccluded1\0")?;
            Ok(Self { name: variant.name, scene, intersect, occluded, _library: library })
        }
    }
}

/// Adds a mesh to a scene.
///
/// # Safety
///
/// The library must be Embree 4, and the handles from it.
unsafe fn attach(
    library: &Library,
    device: Handle,
    scene: Handle,
    mesh: &Mesh,
) -> Result<(), Box<dyn Error>> {
    const INDEX_BUFFER: i32 = 0;
    const VERTEX_BUFFER: i32 = 1;
    const UINT3: i32 = 0x5003;
    const FLOAT3: i32 = 0x9003;
    // SAFETY: as the caller promises; Embree's buffers hold `count` items of 12 bytes.
    unsafe {
        let new_geometry: Symbol<unsafe extern "C" fn(Handle, i32) -> Handle> =
            library.get(b"rtcNewGeometry\0")?;
        let new_buffer: Symbol<
            unsafe extern "C" fn(Handle, i32, u32, i32, usize, usize) -> *mut c_void,
        > = library.get(b"rtcSetNewGeometryBuffer\0")?;
        let commit: Symbol<unsafe extern "C" fn(Handle)> = library.get(b"rtcCommitGeometry\0")?;
        let attach: Symbol<unsafe extern "C" fn(Handle, Handle) -> u32> =
            library.get(b"rtcAttachGeometry\0")?;
        let geometry = new_geometry(device, 0);
        let (vertices, triangles) = (mesh.positions.len(), mesh.indices.len());
        let positions = new_buffer(geometry, VERTEX_BUFFER, 0, FLOAT3, 12, vertices);
        std::ptr::copy_nonoverlapping(mesh.positions.as_ptr(), positions.cast(), vertices);
        let indices = new_buffer(geometry, INDEX_BUFFER, 0, UINT3, 12, triangles);
        std::ptr::copy_nonoverlapping(mesh.indices.as_ptr(), indices.cast(), triangles);
        commit(geometry);
        attach(scene, geometry);
    }
    Ok(())
}

impl Tracer for Scene {
    fn name(&self) -> String {
        format!("embree {}", self.name)
    }

    fn count_closest(&self, rays: &[Ray]) -> usize {
        let hits = |ray: &&Ray| {
            let mut query = RayHit::new(ray);
            // SAFETY: the scene is committed and `query` is an aligned RTCRayHit.
            unsafe { (self.intersect)(self.scene, &mut query, std::ptr::null_mut()) };
            query.geometry != u32::MAX
        };
        rays.iter().filter(hits).count()
    }

    fn count_any(&self, rays: &[Ray]) -> usize {
        let hits = |ray: &&Ray| {
            let mut query = RayHit::new(ray);
            // SAFETY: the scene is committed, and `query` begins with an aligned RTCRay.
            unsafe { (self.occluded)(self.scene, &mut query, std::ptr::null_mut()) };
            query.far == f32::NEG_INFINITY
        };
        rays.iter().filter(hits).count()
    }
}
