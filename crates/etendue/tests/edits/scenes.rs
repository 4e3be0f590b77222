//! Scenes with many kinds of nodes, and their files.

use std::path::Path;
use std::sync::Mutex;

use etendue::document::{MemoryResources, ResourceError, Resources};

/// Meshes with and without attributes, one with an unknown parameter and one whose file has
/// unsupported statements; pictures in materials, on a light and as an environment.
pub(crate) const SURFACES: &str = r#"<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="5"/></integrator>
    <sensor type="perspective" id="eye">
        <float name="fov" value="60"/>
        <transform name="to_world"><lookat origin="0, 1, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/>
            <rfilter type="tent"/></film>
        <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
    </sensor>
    <texture type="bitmap" id="picture"><string name="filename" value="a.pfm"/>
        <string name="wrap_mode" value="clamp"/></texture>
    <bsdf type="twosided" id="coated"><bsdf type="roughplastic"><float name="alpha" value="0.3"/>
        <ref name="diffuse_reflectance" id="picture"/></bsdf></bsdf>
    <shape type="ply"><string name="filename" value="colored.ply"/>
        <transform name="to_world"><translate x="-1"/></transform>
        <bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance">
            <string name="name" value="vertex_color"/></texture></bsdf></shape>
    <shape type="ply"><string name="filename" value="plain.ply"/><integer name="unheard_of" value="1"/>
        <ref id="coated"/></shape>
    <shape type="obj"><string name="filename" value="a.obj"/><ref id="coated"/>
        <emitter type="area"><rgb name="radiance" value="3, 2, 1"/></emitter></shape>
    <shape type="sphere"><point name="center" x="1" y="0.5" z="0"/><float name="radius" value="0.5"/>
        <bsdf type="conductor"/></shape>
    <shape type="rectangle"><transform name="to_world"><translate z="-2"/></transform>
        <emitter type="area"><texture type="bitmap" name="radiance">
            <string name="filename" value="a.pfm"/><boolean name="raw" value="true"/></texture></emitter>
    </shape>
    <emitter type="envmap"><string name="filename" value="sky.pfm"/><float name="scale" value="0.5"/>
        <transform name="to_world"><rotate y="1" angle="30"/></transform></emitter>
    <emitter type="point"><point name="position" x="0" y="3" z="1"/>
        <float name="sampling_weight" value="2"/></emitter>
</scene>"#;

/// Groups, instances, media and grids.
pub(crate) const VOLUMES: &str = r#"<scene version="3.0.0">
    <integrator type="volpath"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="7"/><integer name="height" value="5"/></film>
        <sampler type="independent"/>
    </sensor>
    <shape type="shapegroup" id="pair">
        <shape type="ply"><string name="filename" value="plain.ply"/><bsdf type="roughconductor"/></shape>
        <shape type="cube"><transform name="to_world"><scale value="0.2"/></transform></shape>
    </shape>
    <shape type="shapegroup" id="one"><shape type="sphere"><float name="radius" value="0.3"/></shape></shape>
    <shape type="instance"><ref id="pair"/>
        <transform name="to_world"><translate x="1"/></transform></shape>
    <shape type="instance"><ref id="pair"/>
        <transform name="to_world"><rotate y="1" angle="40"/><translate x="-1"/></transform></shape>
    <shape type="instance"><ref id="one"/>
        <transform name="to_world"><translate y="1"/></transform></shape>
    <shape type="cube"><bsdf type="null"/>
        <medium type="heterogeneous" name="interior">
            <volume type="gridvolume" name="sigma_t"><string name="filename" value="smoke.vol"/>
                <transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale value="2"/></transform></volume>
            <rgb name="albedo" value="0.9, 0.8, 0.7"/><phase type="hg"><float name="g" value="0.4"/></phase>
        </medium></shape>
    <shape type="sphere"><point name="center" x="0" y="-1.5" z="0"/><bsdf type="dielectric"/>
        <medium type="homogeneous" name="interior"><rgb name="sigma_t" value="1, 2, 3"/></medium></shape>
    <emitter type="constant"><rgb name="radiance" value="0.5, 0.7, 1"/></emitter>
    <emitter type="directional"><vector name="direction" x="0.3" y="-1" z="-0.2"/></emitter>
</scene>"#;

/// Shapes other than meshes, several sensors, and an integrator with extra channels.
pub(crate) const SHAPES: &str = r#"<scene version="3.0.0">
    <integrator type="aov"><string name="aovs" value="position:position, shape:shape_index"/>
        <integrator type="path" name="image"/></integrator>
    <sensor type="thinlens" id="lens"><float name="aperture_radius" value="0.1"/>
        <float name="focus_distance" value="4"/>
        <transform name="to_world"><lookat origin="0, 1, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="6"/><integer name="height" value="5"/></film>
    </sensor>
    <sensor type="orthographic">
        <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="5"/><integer name="height" value="4"/>
            <rfilter type="box"/></film>
        <sampler type="stratified"><integer name="sample_count" value="4"/></sampler>
    </sensor>
    <bsdf type="principled" id="paint"><float name="roughness" value="0.4"/></bsdf>
    <shape type="revsurface"><curve type="bezier">
        <vec value="0.5, -1, 0"/><vec value="0.8, -0.5, 0"/><vec value="0.3, 0.5, 0"/>
        <vec value="0.4, 1, 0"/></curve><ref id="paint"/></shape>
    <shape type="linearcurve"><string name="filename" value="hair.txt"/><bsdf type="hair"/></shape>
    <shape type="bsplinecurve"><string name="filename" value="hair.txt"/><ref id="paint"/></shape>
    <shape type="sdfgrid"><string name="filename" value="distance.vol"/>
        <transform name="to_world"><translate x="0.7"/></transform></shape>
    <shape type="disk"><transform name="to_world"><translate x="-1"/></transform>
        <sensor type="irradiancemeter"><film type="hdrfilm"><integer name="width" value="1"/>
            <integer name="height" value="1"/></film></sensor></shape>
    <shape type="cylinder"><float name="radius" value="0.2"/><bsdf type="mask"><float name="opacity" value="0.6"/>
        <bsdf type="diffuse"/></bsdf>
        <emitter type="area"><float name="radiance" value="2"/></emitter></shape>
    <shape type="ply"><string name="filename" value="plain.ply"/><boolean name="face_normals" value="true"/>
        <bsdf type="bumpmap"><texture type="bitmap"><string name="filename" value="a.pfm"/>
            <string name="channel" value="r"/></texture><bsdf type="plastic"/></bsdf></shape>
    <emitter type="spot"><transform name="to_world"><lookat origin="2, 3, 2" target="0, 0, 0" up="0, 1, 0"/></transform></emitter>
</scene>"#;

pub(crate) const COLORED_PLY: &str =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y
property float z\nproperty float r\nproperty float g\nproperty float b\nelement face 2
property list uchar int vertex_indices\nend_header
-1 -1 0 1 0 0\n1 -1 0 0 1 0\n1 1 0 0 0 1\n-1 1 0.3 0.5 0.255 1\n3 0 1 2\n3 0 2 3\n";

pub(crate) const PLAIN_PLY: &str =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y
property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header
-1 -1 -0.5\n1 -1 -0.5\n0 1 -0.5\n3 0 1 2\n";

/// `curv` is an unsupported statement and causes a warning.
const OBJ: &str =
    "v -1 -1 1\nv -0.5 -1 1\nv -1 -0.5 1\nv -0.4 -0.4 1.2\ncurv 1 2\nf 1 2 3\nf 2 4 3\n";

/// Files that count how often they are read.
pub(crate) struct CountedFiles {
    files: Mutex<MemoryResources>,
    reads: Mutex<Vec<String>>,
}

impl CountedFiles {
    pub(crate) fn reads(&self) -> Vec<String> {
        self.reads.lock().unwrap().clone()
    }

    pub(crate) fn forget_reads(&self) {
        self.reads.lock().unwrap().clear();
    }

    pub(crate) fn replace(&self, path: &str, text: &str) {
        self.files.lock().unwrap().insert(path, text);
    }
}

impl Resources for CountedFiles {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
        self.reads.lock().unwrap().push(path.display().to_string());
        self.files.lock().unwrap().read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.lock().unwrap().exists(path)
    }
}

pub(crate) fn files() -> CountedFiles {
    let hair = "0 -1 1 0.05\n0.1 -0.5 1 0.04\n-0.1 0 1 0.04\n0.2 0.5 1 0.03\n0.1 1 1 0.02\n";
    let files = MemoryResources::default()
        .with("/scene/colored.ply", COLORED_PLY)
        .with("/scene/plain.ply", PLAIN_PLY)
        .with("/scene/a.obj", OBJ)
        .with("/scene/hair.txt", hair)
        .with("/scene/a.pfm", picture(4, 3, 0.1))
        .with("/scene/b.pfm", picture(3, 5, 0.2))
        .with("/scene/sky.pfm", picture(8, 4, 0.3))
        .with("/scene/smoke.vol", grid(|[x, y, z]| (x + 2 * y + z) as f32 * 0.25))
        .with("/scene/distance.vol", grid(|[x, _, _]| x as f32 * 0.5 - 0.6));
    CountedFiles { files: Mutex::new(files), reads: Mutex::default() }
}

/// A PFM picture of different colours.
fn picture(width: usize, height: usize, step: f32) -> Vec<u8> {
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for index in 0..3 * width * height {
        bytes.extend((0.05 + (index % 9) as f32 * step).to_le_bytes());
    }
    bytes
}

/// A grid file of 3 by 3 by 3 values.
fn grid(value: impl Fn([usize; 3]) -> f32) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for number in [1_i32, 3, 3, 3, 1] {
        bytes.extend(number.to_le_bytes());
    }
    for bound in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(bound.to_le_bytes());
    }
    for z in 0..3 {
        for y in 0..3 {
            for x in 0..3 {
                bytes.extend(value([x, y, z]).to_le_bytes());
            }
        }
    }
    bytes
}
