//! Figure 5.8: the gravito-bending length of a rod from the height of its loop.

use super::heavy_loops::{LoopOfRod, RODS};
use super::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::HeavyLoop;
use rodlab_files::results::read_nodes;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig5.8",
    title: "Figure 5.8: the gravito-bending length from the height of a loop",
    recipe: &Tabled::new(LoopOfRod::of_figure_5_8, Rows::Series(rows), write, figures),
};

/// The factor of the thesis.
const THESIS: f64 = 0.9066;
/// Number of edges of the drawn loop.
const EDGES: usize = 200;
/// Length of rod that is drawn beyond the loop, L_gb.
const TAIL: f64 = 2.0;

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
struct Row {
    rod: usize,
    rod_name: String,
    gravito_bending_length_m: f64,
    height_m: Option<f64>,
    height_over_length: Option<f64>,
    theory_over_length: f64,
}

/// Writes table and figures.
fn write(page: &mut Page, _: &[Case<LoopOfRod>], rows: &[Row]) -> Result<()> {
    let theory = HeavyLoop::new();
    page.text(&format!(
        "A rod that lies on a table and is folded over onto itself leaves an open loop, whose \
         height h_f gives its gravito-bending length (thesis 5.5.1). The loop leaves the table \
         flat and without moment, and meets the lying part flat and without moment: its height is \
         {:.6} L_gb. The thesis gives h_f = {THESIS} L_gb; that factor belongs to the length \
         (EI/ρgA)^(1/3) = 2^(1/3) L_gb: over that length the height is {:.6}. With L_gb of Eq. \
         5.10, as printed, the factor of the thesis would make every measured L_gb 26 % too large. \
         The simulated loops are static equilibria of the discrete rod, held at both ends. They \
         are ribbons with the same L_gb, because the upright loop of a round rod that is held only \
         at its ends falls to the side. `rodlab solve loop-height` gives the height for any L_gb.",
        theory.height,
        theory.height / libm::cbrt(2.0)
    ));
    page.table(columns! { row in rows;
        "rod" => format!("#{} {}", row.rod, row.rod_name),
        "L_gb in cm" => number(1e2 * row.gravito_bending_length_m, 2),
        "height of the loop in cm, simulated" => number(row.height_m.map(|height| 1e2 * height), 3),
        "over L_gb" => number(row.height_over_length, 5),
        "in theory" => number(row.theory_over_length, 5),
    });
    Ok(())
}

fn rows(case: &Case<LoopOfRod>) -> Result<Vec<Row>> {
    let (rod, name, unit) = RODS[case.run.rod];
    let outputs = read_nodes(&case.directory, case.run.nodes())?;
    let height = outputs.last().map(|output| highest(&output.positions));
    Ok(vec![Row {
        rod,
        rod_name: name.into(),
        gravito_bending_length_m: unit,
        height_m: height,
        height_over_length: height.map(|height| height / unit),
        theory_over_length: HeavyLoop::new().height,
    }])
}

/// Height of the parabola through the highest node and its neighbours.
fn highest(nodes: &[Vector3]) -> f64 {
    let inner = 1..nodes.len().saturating_sub(1);
    let top = inner.max_by(|&one, &other| nodes[one].z.total_cmp(&nodes[other].z));
    let Some(top) = top else {
        return 0.0;
    };
    let [before, here, after] = [top - 1, top, top + 1].map(|node| nodes[node].z);
    let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
    if bend < 0.0 {
        here - 0.5 * slope * slope / bend
    } else {
        here
    }
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let theory = HeavyLoop::new();
    let places = theory.places(EDGES);
    let end = places.last().map_or(0.0, |[x, _]| *x);
    let lying = [[end - TAIL, 0.0]];
    let shape = lying.iter().chain(&places).chain(&lying);
    let shape = curve("loop", shape, |[x, z]| (*x, *z));
    let shape = plot_to_scale(plot("z/L_{gb}", [shape]), "x/L_{gb}");
    let length = |row: &Row| 1e2 * row.gravito_bending_length_m;
    let simulated = curve("simulated", rows, |row| {
        (length(row), row.height_m.map(|height| 1e2 * height))
    });
    let longest = largest(rows.iter().map(length));
    let line = |name: &str, factor: f64| {
        let ends = [0.0, longest];
        curve(name, ends, |length| (length, factor * length)).looking(Look::Dashed)
    };
    let heights = plot(
        "height of the loop in cm",
        [
            simulated.looking(Look::Marks),
            line("theory, 1.1422 L_{gb}", theory.height),
            line("thesis, 0.9066 L_{gb}", THESIS),
        ],
    );
    vec![
        PageFigure::new(
            "fig5.8_shape",
            "The loop of a rod that is folded over onto itself",
            shape,
        ),
        PageFigure::new(
            "fig5.8_height",
            "Height of the loop over the gravito-bending length, simulated and in theory",
            line_plots([heights], "L_{gb} in cm"),
        ),
    ]
}
