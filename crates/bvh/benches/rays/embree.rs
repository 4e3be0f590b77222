//! Embree 4 through its C interface, loaded at run time.

use crate::Tracer;
use crate::clock::{Took, timed};
use crate::triangles::Mesh;
use etendue_math::Ray;
use libloading::{Library, Symbol};
use std::error::Error;
use std::ffi::{CString, c_char, c_void};
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicIsize, Ordering};

/// The instruction set and flags of a scene.
pub(crate) struct Variant {
    pub(crate) name: &'static str,
    isa: &'static str,
    flags: i32,
}

const ROBUST: i32 = 1 << 2;
const MEDIUM: i32 = 1;

/// The variants that we compare with: Embree's default, and the instruction set of our AVX2 tier.
pub(crate) const VARIANTS: [Variant; 4] = [
    Variant { name: "embree", isa: "", flags: 0 },
    Variant { name: "embree robust", isa: "", flags: ROBUST },
    Variant { name: "embree avx2", isa: ",isa=avx2", flags: 0 },
    Variant { name: "embree avx2 robust", isa: ",isa=avx2", flags: ROBUST },
];

type Handle = *mut c_void;

/// `RTCRayHit`: an `RTCRay`, followed by an `RTCHit`.
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
    bytes: Box<AtomicIsize>,
    device: Handle,
    scene: Handle,
    intersect: Trace,
    occluded: Trace,
    release: [unsafe extern "C" fn(Handle); 2],
    // Unloading Embree or its thread library crashes at exit.
    _library: ManuallyDrop<Library>,
}

impl Drop for Scene {
    fn drop(&mut self) {
        let [release_scene, release_device] = self.release;
        // SAFETY: both handles are ours and are not used again.
        unsafe {
            release_scene(self.scene);
            release_device(self.device);
        }
    }
}

/// Counts the memory that Embree holds; `counter` is an `AtomicIsize`.
unsafe extern "C" fn count_memory(counter: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: `Scene::build` passes its counter, which lives as long as the device.
    unsafe { &*counter.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

impl Scene {
    /// Builds a scene, and measures how long that takes.
    pub(crate) fn build(
        path: &str,
        variant: &Variant,
        meshes: &[Mesh],
        threads: usize,
    ) -> Result<(Took, Self), Box<dyn Error>> {
        // SAFETY: the library is Embree 4, these are the signatures of its C interface, and it stays
        // loaded. Buffers are filled within the sizes that they were created with.
        unsafe {
            let library = ManuallyDrop::new(Library::new(path)?);
            let new_device: Symbol<unsafe extern "C" fn(*const c_char) -> Handle> =
                library.get(b"rtcNewDevice\0")?;
            let from_handle = |name: &[u8]| {
                library.get::<unsafe extern "C" fn(Handle) -> Handle>(name).map(|symbol| *symbol)
            };
            let with_handle = |name: &[u8]| {
                library.get::<unsafe extern "C" fn(Handle)>(name).map(|symbol| *symbol)
            };
            let set = |name: &[u8]| {
                library.get::<unsafe extern "C" fn(Handle, i32)>(name).map(|symbol| *symbol)
            };
            let configuration = CString::new(format!("threads={threads}{}", variant.isa))?;
            let device = new_device(configuration.as_ptr());
            let bytes = Box::new(AtomicIsize::new(0));
            type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;
            let monitor: Symbol<unsafe extern "C" fn(Handle, Monitor, *mut c_void)> =
                library.get(b"rtcSetDeviceMemoryMonitorFunction\0")?;
            let scene = from_handle(b"rtcNewScene\0")?(device);
            set(b"rtcSetSceneFlags\0")?(scene, variant.flags);
            set(b"rtcSetSceneBuildQuality\0")?(scene, MEDIUM);
            for mesh in meshes {
                attach(&library, device, scene, mesh)?;
            }
            // Only now, so that the copies of the meshes do not count.
            monitor(device, count_memory, (&raw const *bytes).cast_mut().cast());
            let commit = with_handle(b"rtcCommitScene\0")?;
            let (took, ()) = timed(|| commit(scene));
            let intersect = *library.get::<Trace>(b"rtcIntersect1\0")?;
            let occluded = *library.get::<Trace>(b"rtcOccluded1\0")?;
            let release = [with_handle(b"rtcReleaseScene\0")?, with_handle(b"rtcReleaseDevice\0")?];
            let name = variant.name;
            let _library = library;
            Ok((took, Self { name, bytes, device, scene, intersect, occluded, release, _library }))
        }
    }
}

/// Adds a mesh to a scene.
///
/// # Safety
///
/// The library must be Embree 4, and the handles must come from it.
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
    // SAFETY: guaranteed by the caller; Embree's buffers hold `count` items of 12 bytes.
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
        let release: Symbol<unsafe extern "C" fn(Handle)> = library.get(b"rtcReleaseGeometry\0")?;
        release(geometry);
    }
    Ok(())
}

impl Tracer for Scene {
    fn name(&self) -> String {
        self.name.to_owned()
    }

    fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed).try_into().unwrap_or(0)
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
