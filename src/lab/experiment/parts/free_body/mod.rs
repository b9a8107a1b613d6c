//! Free rigid bodies.

mod joined;
mod keys;
mod solid;

use super::ScenePart;
use crate::scenario::keys::{Part, Section, triangle_mesh};
use crate::scenario::{Issue, KeyPath, Scheme, Time};
use joined::{Axle, Joined};
use keys::{BoxKeys, CylinderKeys, FreeBodyKeys, FreeShapeKeys, MeshKeys};
use rodlab_engine::mechanics::contact::{FrictionAt, Geometry};
use rodlab_engine::mechanics::scene::{self, Scene};
use rodlab_engine::mechanics::system::check_joints;
use rodlab_engine::mechanics::{SceneError, Vector3, rotation};
use serde::Serialize;
use solid::Solid;

/// A free body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FreeBody {
    /// Name for probes, loads and messages.
    pub name: String,
    /// Shape about its centre.
    pub shape: FreeShape,
    /// Position of its centre, m.
    pub position: [f64; 3],
    /// Unit vector along the axis of its rotation.
    pub axis: [f64; 3],
    /// Angle of its rotation, rad.
    pub angle: f64,
    /// Mass, kg; `None` if the density is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Density, kg/m³.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Velocity of its centre of mass, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity, rad/s.
    pub angular_velocity: [f64; 3],
    /// Own friction coefficient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// The axle about which alone it turns.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub axle: Option<Axle>,
    /// Rods that are joined to it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joined: Vec<Joined>,
}

/// The shape of a free body.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum FreeShape {
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
    },
    /// A capsule along z.
    Capsule {
        /// Radius, m.
        radius: f64,
        /// Length between the centres of its ends, m.
        length: f64,
    },
    /// A box.
    Box {
        /// Lengths of its sides, m.
        size: [f64; 3],
        /// Radius of its edges, m.
        rounding: f64,
    },
    /// A prism along z.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Length, m.
        length: f64,
        /// Radius of its edges, m.
        rounding: f64,
        /// Number of sides.
        sides: usize,
    },
    /// A convex mesh.
    Mesh {
        /// Vertices, m.
        vertices: Vec<[f64; 3]>,
        /// Three vertices of each triangle.
        triangles: Vec<[usize; 3]>,
        /// Distance of the surface from the triangles, m.
        rounding: f64,
    },
}

impl FreeShape {
    fn resolve(section: &Section<'_>, typed: &FreeShapeKeys) -> Self {
        match typed {
            FreeShapeKeys::Sphere(typed) => Self::Sphere {
                radius: typed.radius(section),
            },
            FreeShapeKeys::Capsule(typed) => Self::Capsule {
                radius: typed.radius(section),
                length: typed.length(section),
            },
            FreeShapeKeys::Box(typed) => Self::of_box(section, typed),
            FreeShapeKeys::Cylinder(typed) => Self::of_cylinder(section, typed),
            FreeShapeKeys::Mesh(typed) => Self::of_mesh(section, typed),
        }
    }

    fn of_box(section: &Section<'_>, typed: &BoxKeys) -> Self {
        let size = typed.size(section);
        let shortest = size.iter().copied().fold(f64::INFINITY, f64::min);
        let rounding = typed.rounding(section, 0.05 * shortest);
        if rounding >= 0.5 * shortest {
            let half = 0.5 * shortest;
            let allowed = format!("less than half of the shortest side, {half:?} m");
            section.out_of_range("rounding", rounding, allowed);
        }
        Self::Box { size, rounding }
    }

    fn of_cylinder(section: &Section<'_>, typed: &CylinderKeys) -> Self {
        let (radius, length) = (typed.radius(section), typed.length(section));
        let smaller = radius.min(0.5 * length);
        let rounding = typed.rounding(section, 0.1 * smaller);
        if rounding >= smaller {
            let allowed = format!("less than the radius and half of the length, {smaller:?} m");
            section.out_of_range("rounding", rounding, allowed);
        }
        Self::Cylinder {
            radius,
            length,
            rounding,
            sides: typed.sides(section),
        }
    }

    fn of_mesh(section: &Section<'_>, typed: &MeshKeys) -> Self {
        let (rounding, unit) = (typed.rounding(section), typed.unit(section));
        let mesh = triangle_mesh(section, &typed.file, &typed.vertices, &typed.triangles);
        let mesh = mesh.unwrap_or_default();
        let scaled = |vertex: &[f64; 3]| vertex.map(|coordinate| coordinate * unit);
        Self::Mesh {
            vertices: mesh.vertices.iter().map(scaled).collect(),
            triangles: mesh.triangles,
            rounding,
        }
    }

    /// The shape about its centre.
    ///
    /// # Errors
    /// Why a mesh is not that of a convex body.
    fn solid(&self) -> Result<Solid, String> {
        match self {
            Self::Sphere { radius } => Ok(Solid::capsule(*radius, 0.0)),
            Self::Capsule { radius, length } => Ok(Solid::capsule(*radius, *length)),
            Self::Box { size, rounding } => Ok(Solid::cuboid(*size, *rounding)),
            Self::Cylinder {
                radius,
                length,
                rounding,
                sides,
            } => Ok(Solid::prism(*radius, *length, *rounding, *sides)),
            Self::Mesh {
                vertices,
                triangles,
                rounding,
            } => Solid::convex(vertices, triangles, *rounding),
        }
    }
}

impl Part for FreeBody {
    type Typed = FreeBodyKeys;

    const KEY: &'static str = "free_bodies";
    const DESCRIPTION: &'static str =
        "Rigid bodies: balls, boxes, cylinders, convex meshes, pulleys, weights on rods.";

    fn contact_radius(&self) -> f64 {
        match self.shape {
            FreeShape::Sphere { radius } | FreeShape::Capsule { radius, .. } => radius,
            FreeShape::Box { rounding, .. }
            | FreeShape::Cylinder { rounding, .. }
            | FreeShape::Mesh { rounding, .. } => rounding,
        }
    }

    fn resolve(section: &Section<'_>, typed: &FreeBodyKeys, index: usize) -> Self {
        let shape = match &typed.shape {
            Some(shape) => FreeShape::resolve(&section.below("shape"), shape),
            None => {
                let help = "a table such as { kind = \"box\", size = [0.1, 0.1, 0.1] }";
                section.missing("shape", help);
                FreeShape::Box {
                    size: [1.0; 3],
                    rounding: 0.1,
                }
            }
        };
        let (mass, density) = (typed.mass(section), typed.density(section));
        match (mass, density) {
            (None, None) => section.missing("mass", "a mass, or a `density`"),
            (Some(_), Some(_)) => section.fault("density", "give `mass` or `density`, not both"),
            _ => {}
        }
        Self {
            name: typed.name(section, format!("free body {index}")),
            shape,
            position: typed.position(section),
            axis: typed.axis(section),
            angle: typed.angle(section),
            mass,
            density,
            velocity: typed.velocity(section),
            angular_velocity: typed.angular_velocity(section),
            friction: typed.friction(section),
            axle: Axle::resolve(section, typed),
            joined: (section.elements("joined", &typed.joined))
                .map(|(section, typed)| Joined::resolve(&section, typed))
                .collect(),
        }
    }

    fn judge(array: &Section<'_>, all: &[Self], time: &Time) {
        let message = match time {
            _ if all.is_empty() => return,
            Time::Dynamic {
                scheme: Scheme::ImplicitMidpoint,
                ..
            } => "free bodies need time.scheme = \"implicit-euler\" or \"backward-differences\"",
            time if time.finds_equilibria() => {
                "free bodies have no equilibrium without contact: run dynamically, without begin = \"equilibrium\""
            }
            _ => return,
        };
        array.below("0").fault("shape", message);
    }
}

impl ScenePart for FreeBody {
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue> {
        let taken = (scene.rods.iter().map(|rod| &rod.name))
            .chain(scene.free_bodies.iter().map(|body| &body.name));
        if taken.into_iter().any(|name| *name == self.name) {
            let message = format!("another free body or a rod is called `{}`", self.name);
            return Err(Issue::new(path.key("name"), message));
        }
        let solid = (self.shape.solid()).map_err(|why| Issue::new(path.key("shape"), why))?;
        let mass = self
            .mass
            .or(self.density.map(|density| density * solid.volume));
        let mass = mass.unwrap_or_default();
        let rotation = rotation::from_vector(Vector3::from(self.axis) * self.angle);
        let placed = |point: &Vector3| Vector3::from(self.position) + rotation * point;
        let mut shape = solid.body;
        shape
            .vertices
            .iter_mut()
            .for_each(|vertex| *vertex = placed(vertex));
        let (inertia, axes) = (solid.inertia.map(|one| one * mass), rotation * solid.axes);
        let of_axes = axes.to_rotation_matrix().into_inner();
        let mut joints = Vec::new();
        for (index, joined) in self.joined.iter().enumerate() {
            joints.push(joined.placed(&scene.rods, &path.key("joined").index(index))?);
        }
        scene.free_bodies.push(scene::FreeBody {
            name: self.name.clone(),
            shape,
            mass,
            centre: placed(&solid.centre),
            inertia,
            axes,
            velocity: Vector3::from(self.velocity),
            angular_velocity: Vector3::from(self.angular_velocity),
            friction: self.friction,
            axle: (self.axle.as_ref()).map(|axle| axle.placed(inertia, &of_axes)),
            joints,
        });
        Ok(())
    }
}

/// Checks whether the rest of a scene allows its free bodies.
///
/// # Errors
/// What does not, with its key.
pub fn judge(scene: &Scene) -> Result<(), Issue> {
    if scene.free_bodies.is_empty() {
        return Ok(());
    }
    let fault = |key: KeyPath, allowed: &str| {
        Err(Issue::new(key, format!("with [[free_bodies]], {allowed}")))
    };
    let mut bodies = scene.free_bodies.iter();
    if scene.contact.is_none()
        && let Some(index) = bodies.position(|body| body.friction.is_some())
    {
        let path = KeyPath::from(FreeBody::KEY).index(index);
        let message =
            "without a [contact] table bodies pass through everything; add one, or leave it out";
        return Err(Issue::new(path.key("friction"), message));
    }
    if let Err(SceneError::Joint { name, reason }) = check_joints(scene) {
        let mut bodies = scene.free_bodies.iter();
        let index = bodies.position(|body| body.name == name);
        let path = KeyPath::from(FreeBody::KEY).index(index.unwrap_or_default());
        let message = format!("`{name}`: {reason}");
        return Err(Issue::new(path.key("joined"), message));
    }
    if scene.fluid.is_some() {
        return fault(KeyPath::from("fluid").key("model"), "there can be no fluid");
    }
    let Some(contact) = &scene.contact else {
        return Ok(());
    };
    let key = |key: &str| KeyPath::from("contact").key(key);
    if contact.geometry == Geometry::Smooth {
        return fault(key("geometry"), "the geometry is \"polyline\"");
    }
    if contact.friction_at == FrictionAt::Surface {
        let allowed =
            "friction of rods is at the \"centreline\"; that of the bodies is at their surfaces";
        return fault(key("friction_at"), allowed);
    }
    let mut planes = scene.planes.iter();
    if let Some(plane) = planes.position(|plane| plane.directed_friction.is_some()) {
        let key = KeyPath::from("planes")
            .index(plane)
            .key("directed_friction");
        return fault(key, "friction does not depend on the direction");
    }
    let mut obstacles = scene.obstacles.iter();
    if let Some(obstacle) = obstacles.position(|obstacle| obstacle.body.hollow) {
        let key = KeyPath::from("obstacles").index(obstacle).key("shape");
        return fault(key, "there can be no obstacle of kind \"tube\"");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::parts::test_support::prepared;
    use rodlab_engine::mechanics::scene::JointKind;

    const SCENE: &str = r#"experiment = "scene"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "wire"
radius = 0.01
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[time]
end = 1.0
[[free_bodies]]
BODY
"#;

    fn with(body: &str) -> String {
        SCENE.replace("BODY", body)
    }

    #[test]
    fn a_box_is_turned_about_its_centre_and_has_the_mass_of_its_density() {
        let scene = prepared(&with(
            "name = \"block\"\nshape = { kind = \"box\", size = [\"20 cm\", \"10 cm\", \"10 cm\"] }\nposition = [1, 2, 3]\nangle = \"90 deg\"\ndensity = 500.0\nvelocity = [0, 0, -1]",
        ))
        .unwrap();
        let body = &scene.free_bodies[0];
        assert!((body.mass - 1.0).abs() < 1e-12);
        assert_eq!(body.centre, Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(body.velocity, -Vector3::z());
        assert!((body.shape.radius - 5e-3).abs() < 1e-15);
        let farthest = body.shape.vertices.iter().map(|x| (x.y - 2.0).abs());
        assert!((farthest.fold(0.0, f64::max) - 0.095).abs() < 1e-12);
        let [x, y, z] = body.inertia;
        assert!((x - 1.0 / 600.0).abs() < 1e-12 && (y - 5.0 / 1200.0).abs() < 1e-12 && y == z);
    }

    #[test]
    fn a_body_is_joined_to_rods_and_turns_about_an_axle_with_its_moment_of_inertia() {
        let ball =
            "shape = { kind = \"sphere\", radius = 0.1 }\nposition = [1.1, 0, 0]\nmass = 2.0";
        let joined = |joint: &str| {
            let text = with(&format!("{ball}\njoined = [{{ rod = \"wire\", {joint} }}]"));
            prepared(&text).map(|scene| scene.free_bodies[0].joints.clone())
        };
        let joint = joined("at = \"end\"").unwrap()[0];
        assert_eq!((joint.at.rod, joint.at.node), (0, 10));
        assert_eq!(joint.kind, JointKind::Ball);
        let joint = joined("at = 3, kind = \"hinge\", axis = [0, 0, 2]").unwrap()[0];
        let JointKind::Hinge { axis, .. } = joint.kind else {
            panic!("a hinge: {joint:?}");
        };
        assert_eq!((joint.at.node, axis), (3, Vector3::z()));
        let keys = "axle = [0, 3, 4]\nbrake = \"5 mN m\"\ntorque = [[0, 1], [2, 3]]";
        let disk = "shape = { kind = \"cylinder\", radius = 0.2, length = 0.1 }\nposition = [0, 0, 1]\nmass = 2.0";
        let axle = prepared(&with(&format!("{disk}\n{keys}"))).unwrap();
        let axle = axle.free_bodies[0].axle.clone().unwrap();
        assert!((axle.direction - Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-15);
        let (along, across) = (0.04, 0.02 + 0.1 * 0.1 / 6.0);
        let inertia = 0.36 * across + 0.64 * along;
        assert!((axle.inertia - inertia).abs() < 1e-15, "{}", axle.inertia);
        assert_eq!((axle.brake, axle.torque.len()), (5e-3, 2));
        let given = format!("{disk}\n{keys}\ninertia = \"3 kg m^2\"");
        let given = prepared(&with(&given)).unwrap();
        assert_eq!(given.free_bodies[0].axle.as_ref().unwrap().inertia, 3.0);
        for (keys, key, expected) in [
            ("brake = 1.0", "brake", "with an `axle`"),
            (
                "axle = [0, 0, 1]\nvelocity = [1, 0, 0]",
                "velocity",
                "does not move",
            ),
            (
                "axle = [0, 0, 1]\nangular_velocity = [1, 0, 1]",
                "angular_velocity",
                "about its `axle` alone",
            ),
            (
                "joined = [{ rod = \"wire\", at = 3, axis = [0, 0, 1] }]",
                "axis",
                "of the kind \"hinge\"",
            ),
            (
                "joined = [{ rod = \"wire\", at = 3, kind = \"hinge\" }]",
                "axis",
                "missing key `axis`",
            ),
            (
                "joined = [{ rod = \"wir\", at = 3 }]",
                "rod",
                "no rod is called `wir`",
            ),
            ("joined = [{ rod = \"wire\", at = 11 }]", "at", "11"),
            (
                "joined = [{ rod = \"wire\", at = 3 }, { rod = \"wire\", at = 3 }]",
                "joined",
                "no other joint, clamp, slide or body",
            ),
            (
                "axle = [0, 0, 1]\njoined = [{ rod = \"wire\", at = 3, kind = \"hinge\", axis = [0, 1, 0] }]",
                "joined",
                "connected to another hinge",
            ),
        ] {
            let error = prepared(&with(&format!("{ball}\n{keys}"))).unwrap_err();
            assert!(error.contains(expected), "{keys}: {error}");
            assert!(error.contains(key), "{error}");
        }
    }

    #[test]
    fn a_mesh_from_a_file_is_the_same_body_in_its_unit() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("wedge.obj");
        let text = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        std::fs::write(&file, text).unwrap();
        let place = "rounding = 0.01 }\nposition = [0, 0, 1]\nmass = 1.0";
        let listed = "vertices = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], \
                      triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]";
        let filed = format!("file = {file:?}, unit = \"1 mm\"");
        let [listed, filed] = [listed, &filed].map(|keys| {
            let keys = format!("shape = {{ kind = \"mesh\", {keys}, {place}");
            prepared(&with(&keys)).unwrap().free_bodies.remove(0).shape
        });
        assert_eq!(listed, filed);
    }

    #[test]
    fn faults_of_free_bodies_name_the_key_and_what_is_allowed() {
        let block = "shape = { kind = \"box\", size = [0.1, 0.1, 0.1] }\nposition = [0, 0, 1]";
        let mesh = |triangles: &str| {
            format!(
                "shape = {{ kind = \"mesh\", vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], triangles = {triangles}, rounding = 0.01 }}\nposition = [0, 0, 1]\nmass = 1.0"
            )
        };
        for (keys, key, expected) in [
            (
                "position = [0, 0, 1]\nmass = 1.0".to_owned(),
                "shape",
                "missing key `shape`",
            ),
            (block.to_owned(), "mass", "missing key `mass`"),
            (
                format!("{block}\nmass = 1.0\ndensity = 1.0"),
                "density",
                "not both",
            ),
            (
                format!("{block}\nmass = 1.0\nname = \"wire\""),
                "name",
                "is called `wire`",
            ),
            (
                format!("{block}\nmass = 1.0").replace("] }", "], rounding = 0.05 }"),
                "rounding",
                "less than half of the shortest side",
            ),
            (mesh("[[0, 2, 1], [0, 1, 3], [0, 3, 2]]"), "shape", "holes"),
            (
                mesh("[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 7]]"),
                "shape",
                "there is no vertex 7",
            ),
            (
                mesh("[[0, 2, 1]]").replace("vertices", "file = \"a.stl\", vertices"),
                "file",
                "not both",
            ),
        ] {
            let error = prepared(&with(&keys)).unwrap_err();
            assert!(error.contains(expected), "{keys}: {error}");
            assert!(error.contains(key), "{error}");
        }
        let body = with(&format!("{block}\nmass = 1.0"));
        let contact = "[contact]\nmodel = \"imc\"\n";
        for (more, key) in [
            (
                format!("{contact}geometry = \"smooth\"\n"),
                "contact.geometry",
            ),
            (
                format!("{contact}friction_at = \"surface\"\n"),
                "contact.friction_at",
            ),
            (
                format!(
                    "{contact}[[obstacles]]\nshape = {{ kind = \"tube\", start = [0, 0, 0], end = [0, 0, 1], radius = 1.0 }}\n"
                ),
                "obstacles.0.shape",
            ),
            (
                "[fluid]\nmodel = \"resistive\"\nviscosity = 1.0\n".to_owned(),
                "fluid.model",
            ),
        ] {
            let error = prepared(&format!("{body}{more}")).unwrap_err();
            assert!(
                error.contains(key) && error.contains("free_bodies"),
                "{error}"
            );
        }
        let rigid = "[contact]\nmodel = \"complementarity\"\n";
        prepared(&format!("{body}{rigid}")).unwrap();
        let rubs = with(&format!("{block}\nmass = 1.0\nfriction = 0.2"));
        let scene = prepared(&format!("{rubs}{rigid}")).unwrap();
        assert_eq!(scene.free_bodies[0].friction, Some(0.2));
        let error = prepared(&rubs).unwrap_err();
        let is_named = error.contains("free_bodies.0.friction");
        assert!(is_named && error.contains("[contact]"), "{error}");
        for (time, expected) in [
            ("mode = \"static\"", "run dynamically"),
            (
                "end = 1.0\nscheme = \"implicit-midpoint\"",
                "backward-differences",
            ),
        ] {
            let error = prepared(&body.replace("end = 1.0", time)).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
