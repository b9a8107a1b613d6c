//! Wavefront OBJ files: vertices `v x y z` and faces `f a b c ...`, whose polygons are cut into
//! triangles from their first corner. Textures, normals, groups and lines are ignored.

use super::{MOST_TRIANGLES, Mesh};
use crate::finite;

pub fn parse(bytes: &[u8]) -> Result<Mesh, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "is not an OBJ file: it is not text")?;
    let mut mesh = Mesh::default();
    for (index, line) in text.lines().enumerate() {
        let fault = |what: &str| format!("has an error in line {}: {what}", index + 1);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || finite::number(words.next()?);
                let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
                    return Err(fault("a vertex needs three finite numbers"));
                };
                mesh.vertices.push([x, y, z]);
            }
            Some("f") => {
                let corners: Option<Vec<usize>> = words
                    .map(|word| corner(word, mesh.vertices.len()))
                    .collect();
                let corners = corners
                    .ok_or_else(|| fault("a face refers to a vertex that does not exist"))?;
                if corners.len() < 3 {
                    return Err(fault("a face needs at least three corners"));
                }
                let rest = corners[1..].windows(2);
                mesh.triangles
                    .extend(rest.map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
        if mesh.triangles.len() > MOST_TRIANGLES {
            return Err(format!("has too many triangles; allowed: {MOST_TRIANGLES}"));
        }
    }
    if mesh.triangles.is_empty() {
        return Err("is not an OBJ file, or has no faces".into());
    }
    Ok(mesh)
}

/// The vertex of `7`, `7/1`, `7//2` or `7/1/2`, counted from 1, or backwards from the last vertex
/// if negative.
fn corner(word: &str, vertices: usize) -> Option<usize> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 {
        i64::try_from(vertices).ok()?.checked_add(number)?
    } else {
        number - 1
    };
    usize::try_from(index)
        .ok()
        .filter(|index| *index < vertices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn polygons_are_cut_into_triangles() {
        let text = "# a square and a triangle\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf \
                    1//1 2//1 3//1 4//1\nf -1 1/2 2/3/4\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.vertices[2], [1.0, 1.0, 0.0]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 0, 1]]);
    }

    #[test]
    fn faults_name_their_line() {
        let fault = |text: &str| parse(text.as_bytes()).unwrap_err();
        assert_eq!(
            fault("v 0 0\n"),
            "has an error in line 1: a vertex needs three finite numbers"
        );
        assert!(fault("v 0 0 0\nv nan 0 0\n").contains("line 2: a vertex"));
        assert!(fault("v 0 0 1e999\n").contains("finite"));
        assert!(fault("v 0 0 0\nf 1 2 3\n").contains("line 2"));
        assert!(fault("v 0 0 0\nf 1 1\n").contains("three corners"));
        assert!(fault("hello").contains("no faces"));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[vf0-9 ./\n-]{0,80}") {
            let _ = parse(text.as_bytes());
        }
    }
}
