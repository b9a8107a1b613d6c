//! The part of a URDF file that kinematics and collision checks use: links with their collision
//! shapes, and joints. Everything else is ignored.

use rodlab_files::input;
use roxmltree::{Document, Node, ParsingOptions};

/// Largest number of XML nodes of a file.
const MOST_NODES: u32 = 1_000_000;

/// A robot.
#[derive(Debug, Default)]
pub(super) struct Robot {
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
    /// Messages about ignored parts and assumed values.
    pub notes: Vec<String>,
}

#[derive(Debug)]
pub(super) struct Link {
    pub name: String,
    pub line: u32,
    pub collision: Vec<Collision>,
}

#[derive(Debug)]
pub(super) struct Collision {
    pub origin: Origin,
    pub geometry: Geometry,
}

#[derive(Debug)]
pub(super) enum Geometry {
    Box {
        size: [f64; 3],
    },
    /// The length of a capsule is the distance between the centres of its half spheres.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Capsule {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    Mesh {
        filename: String,
        scale: [f64; 3],
    },
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum JointType {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    /// A type that is not supported in a chain.
    Other(String),
}

#[derive(Debug)]
pub(super) struct Joint {
    pub name: String,
    pub line: u32,
    pub joint_type: JointType,
    pub origin: Origin,
    pub parent: String,
    pub child: String,
    pub axis: [f64; 3],
    pub limit: Limit,
    pub mimic: Option<Mimic>,
}

/// Limits that the file states.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Limit {
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub velocity: Option<f64>,
    pub acceleration: Option<f64>,
    pub jerk: Option<f64>,
}

#[derive(Debug)]
pub(super) struct Mimic {
    pub joint: String,
    pub multiplier: f64,
    pub offset: f64,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Origin {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
}

impl Robot {
    /// Reads a URDF file; `name` is the name of the file, used in messages that give a conversion
    /// command.
    ///
    /// # Errors
    /// A message, with its line, if the text is not XML, is in another format, or has a required
    /// element that cannot be read.
    pub fn read(text: &str, name: &str) -> Result<Self, String> {
        input::check_nesting(text)?;
        let options = ParsingOptions {
            allow_dtd: true,
            nodes_limit: MOST_NODES,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options)
            .map_err(|error| format!("not a URDF file: {error}"))?;
        let root = document.root_element();
        is_urdf(root, text, name)?;
        let mut robot = Self::default();
        // Elements of another namespace belong to other programs.
        let namespace = root.tag_name().namespace();
        let is_own = |node: &Node| node.is_element() && node.tag_name().namespace() == namespace;
        for node in root.children().filter(is_own) {
            match node.tag_name().name() {
                "link" => {
                    let link = robot.link(node)?;
                    robot.links.push(link);
                }
                "joint" => robot.joints.push(joint(node)?),
                _ => {}
            }
        }
        Ok(robot)
    }

    fn link(&mut self, node: Node) -> Result<Link, String> {
        let name = required(node, "name")?.to_owned();
        let mut collision = Vec::new();
        for shape in children(node, "collision") {
            let found = child(shape, "geometry").map(|geometry| {
                let kinds = geometry.children().filter(Node::is_element);
                kinds.map(|kind| (kind, geometry_of(kind)))
            });
            let mut known = false;
            for (kind, geometry) in found.into_iter().flatten() {
                if let Some(geometry) = geometry.map_err(|error| in_link(&name, error))? {
                    known = true;
                    collision.push(Collision {
                        origin: origin(shape)?,
                        geometry,
                    });
                    break;
                }
                self.notes.push(format!(
                    "line {}: link `{name}`: collision shapes <{}> are ignored",
                    line(kind),
                    kind.tag_name().name()
                ));
                known = true;
            }
            if !known {
                self.notes.push(format!(
                    "line {}: link `{name}`: a <collision> without a shape is ignored",
                    line(shape)
                ));
            }
        }
        Ok(Link {
            name,
            line: line(node),
            collision,
        })
    }
}

fn in_link(name: &str, error: String) -> String {
    format!("link `{name}`: {error}")
}

/// Name of the URDF file that a converter is to write: never that of its input, which a shell
/// empties before the converter reads it.
fn converted_name(name: &str) -> String {
    let stem = name.split('.').next().unwrap_or(name);
    let converted = format!("{stem}.urdf");
    if converted.eq_ignore_ascii_case(name) {
        format!("{stem}_expanded.urdf")
    } else {
        converted
    }
}

/// Rejects other descriptions of robots, and reports a converter to URDF.
fn is_urdf(root: Node, text: &str, name: &str) -> Result<(), String> {
    let converted = converted_name(name);
    let is_xacro = |node: Node| {
        node.tag_name()
            .namespace()
            .is_some_and(|space| space.contains("xacro"))
            || node.attributes().any(|attribute| {
                attribute.value().contains("${") || attribute.value().contains("$(")
            })
    };
    match root.tag_name().name() {
        "robot" => match root.descendants().find(|node| is_xacro(*node)) {
            Some(node) => Err(format!(
                "line {}: <{}>: this is a xacro file; convert it to URDF first: `xacro {name} > {converted}`",
                line(node),
                node.tag_name().name()
            )),
            None => Ok(()),
        },
        _ if text.contains("xmlns:xacro") => Err(format!(
            "this is a xacro file; convert it to URDF first: `xacro {name} > {converted}`"
        )),
        "mujoco" => Err(format!(
            "this is an MJCF file of MuJoCo; convert it to URDF first: `pip install mjcf-urdf-simple-converter`, then \
             `python -c \"from mjcf_urdf_simple_converter import convert; convert('{name}', '{converted}')\"`"
        )),
        "sdf" | "gazebo" | "world" => Err(format!(
            "this is an SDF file of Gazebo; convert it to URDF first, with pysdf: `rosrun pysdf \
             sdf2urdf.py {name} {converted}`"
        )),
        other => Err(format!(
            "not a URDF file: line {}: its root is <{other}>, expected <robot>",
            line(root)
        )),
    }
}

fn joint(node: Node) -> Result<Joint, String> {
    let name = required(node, "name")?.to_owned();
    let joint_type = match required(node, "type")? {
        "revolute" => JointType::Revolute,
        "continuous" => JointType::Continuous,
        "prismatic" => JointType::Prismatic,
        "fixed" => JointType::Fixed,
        other => JointType::Other(other.to_owned()),
    };
    let end = |role: &str| {
        let end = child(node, role)
            .ok_or_else(|| format!("line {}: joint `{name}` has no <{role}>", line(node)))?;
        required(end, "link").map(str::to_owned)
    };
    let moves = joint_type != JointType::Fixed;
    let used = |tag: &str| child(node, tag).filter(|_| moves);
    let axis = used("axis").map(|axis| triple(axis, "xyz")).transpose()?;
    let limit = match used("limit") {
        None => Limit::default(),
        Some(limit) => Limit {
            lower: number(limit, "lower")?,
            upper: number(limit, "upper")?,
            velocity: number(limit, "velocity")?,
            acceleration: number(limit, "acceleration")?,
            jerk: number(limit, "jerk")?,
        },
    };
    let mimic = used("mimic").map(|mimic| {
        Ok::<_, String>(Mimic {
            joint: required(mimic, "joint")?.to_owned(),
            multiplier: number(mimic, "multiplier")?.unwrap_or(1.0),
            offset: number(mimic, "offset")?.unwrap_or(0.0),
        })
    });
    Ok(Joint {
        parent: end("parent")?,
        child: end("child")?,
        line: line(node),
        origin: origin(node)?,
        axis: axis.flatten().unwrap_or([1.0, 0.0, 0.0]),
        mimic: mimic.transpose()?,
        joint_type,
        limit,
        name,
    })
}

/// A shape; `None` for an unknown kind.
fn geometry_of(node: Node) -> Result<Option<Geometry>, String> {
    let length = |name: &str| {
        number(node, name)?.ok_or_else(|| {
            format!(
                "line {}: <{}> has no `{name}`",
                line(node),
                node.tag_name().name()
            )
        })
    };
    Ok(Some(match node.tag_name().name() {
        "box" => Geometry::Box {
            size: triple(node, "size")?
                .ok_or_else(|| format!("line {}: <box> has no `size`", line(node)))?,
        },
        "cylinder" => Geometry::Cylinder {
            radius: length("radius")?,
            length: length("length")?,
        },
        "capsule" => Geometry::Capsule {
            radius: length("radius")?,
            length: length("length")?,
        },
        "sphere" => Geometry::Sphere {
            radius: length("radius")?,
        },
        "mesh" => Geometry::Mesh {
            filename: node.attribute("filename").unwrap_or_default().to_owned(),
            scale: match numbers(node, "scale")?[..] {
                [] => [1.0; 3],
                [all] => [all; 3],
                [x, y, z] => [x, y, z],
                _ => return Err(wrong(node, "scale", "one number or three")),
            },
        },
        _ => return Ok(None),
    }))
}

fn origin(node: Node) -> Result<Origin, String> {
    let Some(origin) = child(node, "origin") else {
        return Ok(Origin::default());
    };
    Ok(Origin {
        xyz: triple(origin, "xyz")?.unwrap_or_default(),
        rpy: triple(origin, "rpy")?.unwrap_or_default(),
    })
}

fn children<'a>(node: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn line(node: Node) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

fn wrong(node: Node, name: &str, expected: &str) -> String {
    format!(
        "line {}: <{}>: `{name}` is \"{}\", expected {expected}",
        line(node),
        node.tag_name().name(),
        node.attribute(name).unwrap_or_default()
    )
}

fn required<'a>(node: Node<'a, 'a>, name: &str) -> Result<&'a str, String> {
    let value = node
        .attribute(name)
        .map(str::trim)
        .filter(|value| !value.is_empty());
    value.ok_or_else(|| {
        let about = node.ancestors().find_map(|above| above.attribute("name"));
        let about = about.map_or(String::new(), |about| format!(" of `{about}`"));
        format!(
            "line {}: <{}>{about} has no `{name}`",
            line(node),
            node.tag_name().name()
        )
    })
}

/// The numbers of an attribute, separated by white space; none if it is missing or empty.
fn numbers(node: Node, name: &str) -> Result<Vec<f64>, String> {
    let text = node.attribute(name).unwrap_or_default();
    let numbers: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|number| number.parse().ok())
        .collect();
    numbers.ok_or_else(|| wrong(node, name, "numbers separated by blanks"))
}

fn number(node: Node, name: &str) -> Result<Option<f64>, String> {
    match numbers(node, name)?[..] {
        [] => Ok(None),
        [number] => Ok(Some(number)),
        _ => Err(wrong(node, name, "one number")),
    }
}

fn triple(node: Node, name: &str) -> Result<Option<[f64; 3]>, String> {
    match numbers(node, name)?[..] {
        [] => Ok(None),
        [x, y, z] => Ok(Some([x, y, z])),
        _ => Err(wrong(node, name, "three numbers")),
    }
}
