//! Readers of cells, robots, their motions and pictures, and meshes.

use super::{damaged, feed, feed_file, texts};
use rodlab::cell::Cell;
use rodlab::input::check_nesting;
use rodlab::mesh;
use rodlab::robot::{Bag, JointTrajectory, read_table, read_urdf};

const ARM: &[u8] = br#"<robot name="arm"><link name="a"/><link name="b"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<link name="c"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.1" rpy="0 0 1"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="k" type="prismatic"><parent link="b"/><child link="c"/>
<axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="j" multiplier="2" offset="0.1"/></joint></robot>"#;

#[test]
fn cells_and_robots_do_not_panic() {
    let cells = texts("scenarios/cells", "toml");
    let seeds: Vec<&[u8]> = cells.iter().map(String::as_bytes).collect();
    feed_file("cell", 0.02, "cell.toml", &seeds, Cell::read);
    feed_file("urdf", 0.02, "arm.urdf", &[ARM], |path| {
        read_urdf(path, None, None)
    });
}

/// Elements inside a robot that are opened and closed in any order and depth.
#[test]
fn nested_robots_do_not_panic() {
    let parts = [
        "<link name='a'>",
        "</link>",
        "<collision>",
        "</collision>",
        "<b>",
        "</b>",
        "<c/>",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "<geometry>",
        "</geometry>",
        "<joint name=\"j\" type=\"fixed\">",
        "</joint>",
        "\"",
        "'",
        ">",
        "<",
        "&lt;",
        "x",
    ];
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("arm.urdf");
    feed("nested urdf", 0.01, |random| {
        let mut text = "<robot name='r'>".to_owned();
        for _ in 0..random.below(40) {
            let most = 1 + random.below(60);
            let part = random.one_of(&parts);
            text += &part.repeat(1 + random.below(most));
        }
        if random.below(2) == 0 {
            text += "</robot>";
        }
        let _ = check_nesting(&text);
        std::fs::write(&path, &text).unwrap();
        let read = read_urdf(&path, None, None);
        (text, read.into())
    });
}

const MOTION: &[u8] = b"time_s,arm.a_rad,arm.b_m\n0,0,0\n0.5,0.1,1e-3\n1,0.2,0.1\n";

#[test]
fn motions_of_joints_do_not_panic() {
    feed_file(
        "joint trajectory",
        0.02,
        "joints.csv",
        &[MOTION],
        JointTrajectory::read,
    );
    feed_file("table", 0.01, "table.csv", &[MOTION], read_table);
}

const STL: &[u8] = b"solid t\nfacet normal 0 0 -1 outer loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop endfacet\nendsolid t\n";
const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf -1 -2 -3\n";

#[test]
fn meshes_do_not_panic() {
    let mut binary = vec![0; 80];
    binary.extend(1_u32.to_le_bytes());
    binary.extend([0; 12]);
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32];
    binary.extend(corners.iter().flat_map(|number| number.to_le_bytes()));
    binary.extend([0; 2]);
    for (name, ending, seeds) in [
        ("stl", "stl", &[STL, &binary][..]),
        ("obj", "obj", &[OBJ][..]),
    ] {
        feed(name, 0.01, |random| {
            let bytes = damaged(random.one_of(seeds), random);
            let read = mesh::parse(&bytes, ending);
            (String::from_utf8_lossy(&bytes).into_owned(), read.into())
        });
    }
}

/// A record of a ROS 1 bag: header fields, then data.
fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend(((name.len() + 1 + value.len()) as u32).to_le_bytes());
        header.extend([name.as_bytes(), b"=", value].concat());
    }
    let sized = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    [sized(&header), sized(data)].concat()
}

/// A bag with one picture of two by one pixels.
fn bag() -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let topic: [(&str, &[u8]); 3] = [("op", &[7]), ("conn", &[0; 4]), ("topic", b"/color/image")];
    let connection = record(&topic, &text("type=sensor_msgs/Image"));
    let mut image = vec![0; 16];
    image.extend([1_u32, 2].iter().flat_map(|number| number.to_le_bytes()));
    image.extend(text("rgb8"));
    image.push(0);
    image.extend([6_u32, 6].iter().flat_map(|number| number.to_le_bytes()));
    image.extend([1, 2, 3, 4, 5, 6]);
    let message: [(&str, &[u8]); 3] = [("op", &[2]), ("conn", &[0; 4]), ("time", &[1; 8])];
    let data = [connection.clone(), record(&message, &image)].concat();
    let size = (data.len() as u32).to_le_bytes();
    let fields: [(&str, &[u8]); 3] = [("op", &[5]), ("compression", b"none"), ("size", &size)];
    let chunk = record(&fields, &data);
    let head = |index: u64| {
        let fields: [(&str, &[u8]); 2] = [("op", &[3]), ("index_pos", &index.to_le_bytes())];
        [b"#ROSBAG V2.0\n".to_vec(), record(&fields, b"   ")].concat()
    };
    let index = head(0).len() + chunk.len();
    [head(index as u64), chunk, connection].concat()
}

#[test]
fn bags_do_not_panic() {
    feed_file("bag", 0.01, "scene.bag", &[&bag()], |path| {
        Bag::open(path, None)?.collect::<Result<Vec<_>, _>>()
    });
}
