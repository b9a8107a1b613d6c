//! The files of a design.

use super::error::DesignError;
use super::figure::design_figure;
use super::outcome::Design;
use super::task::Designed;
use rodlab_files::figure::Paper;
use rodlab_files::results::{ResultsError, write_files};
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

/// The result in numbers.
pub const RESULT: &str = "design.json";
/// The designed scenario.
pub const DESIGNED: &str = "designed.toml";
/// Natural strains of the nodes, for the key `natural_shape` of a rod.
pub const NATURAL: &str = "natural.csv";
/// Nodes of the target curve, in equilibrium, and without stress or before the design.
pub const NODES: &str = "nodes.csv";
/// The three curves as a figure.
pub const FIGURE: &str = "design.svg";

/// Writes all files into a directory, which is created if it is missing. Each file is written
/// completely or not at all. Returns their paths.
///
/// # Errors
/// A file that cannot be written.
pub fn write(directory: &Path, designed: &Design) -> Result<Vec<PathBuf>, DesignError> {
    let json = serde_json::to_vec_pretty(designed).map_err(io::Error::from);
    let json = json.map_err(ResultsError::io("write", &directory.join(RESULT)))?;
    let mut files = vec![
        (RESULT, json),
        (DESIGNED, designed.scenario_toml().as_bytes().to_vec()),
    ];
    if let Design::Shape(designed) = designed {
        files.push((NATURAL, natural(designed).into_bytes()));
    }
    let figure = design_figure(designed).svg(&Paper::default());
    files.extend([
        (NODES, nodes(designed).into_bytes()),
        (FIGURE, figure.into_bytes()),
    ]);
    Ok(write_files(directory, &files)?)
}

fn natural(designed: &Designed) -> String {
    let mut text = "# natural curvatures about both material directors in 1/m, twist in rad/m\narc_length_m,curvature_1,curvature_2,twist\n".to_owned();
    let natural = &designed.natural;
    let mut at = 0.0;
    for (node, [one, other]) in natural.curvature.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{at:?},{one:?},{other:?},{:?}", natural.twist[node]);
        at += natural.lengths.get(node).unwrap_or(&0.0);
    }
    text
}

fn nodes(designed: &Design) -> String {
    let name = match designed {
        Design::Shape(_) => "unloaded",
        Design::Numbers(_) => "before",
    };
    let mut text = format!(
        "node,wanted_x_m,wanted_y_m,wanted_z_m,x_m,y_m,z_m,{name}_x_m,{name}_y_m,{name}_z_m\n"
    );
    let [wanted, equilibrium, other] = designed.nodes();
    for (node, wanted) in wanted.iter().enumerate() {
        let _ = write!(text, "{node}");
        for point in [wanted, &equilibrium[node], &other[node]] {
            let _ = write!(text, ",{:?},{:?},{:?}", point.x, point.y, point.z);
        }
        text.push('\n');
    }
    text
}
