//! Figures 3.10 and 3.11: inversion points of the simplified knot and in the full simulation.

use super::figure_3_9::SPINS;
use super::inversion::Inversion;
use super::prelude::*;
use rodlab_planning::knot::SimplifiedKnot;

pub(super) const FIGURE_3_10: Artifact = Artifact {
    name: "fig3.10",
    title: "Figure 3.10: the simplified knot over the radius",
    recipe: &Tabled::new(
        Inversion::of_figure_3_5,
        Rows::Row(row),
        |page, _, rows| RADIUS.write(page, rows),
        |rows| RADIUS.figures(rows),
    ),
};

pub(super) const FIGURE_3_11: Artifact = Artifact {
    name: "fig3.11",
    title: "Figure 3.11: the simplified knot over the unknotting number",
    recipe: &Tabled::new(
        Inversion::of_figure_3_6,
        Rows::Row(row),
        |page, _, rows| UNKNOTTING_NUMBER.write(page, rows),
        |rows| UNKNOTTING_NUMBER.figures(rows),
    ),
};

/// A row of the CSV file: inversion points l̄_k.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Row {
    unknotting_number: usize,
    radius_m: f64,
    simulated: Option<f64>,
    clamped: Option<f64>,
    free_to_spin: Option<f64>,
}

/// Quantity on the horizontal axis.
struct Factor {
    /// Name of the figure.
    name: &'static str,
    /// Heading in the table.
    head: &'static str,
    /// Label in the figure.
    axis: &'static str,
    /// Position of a row on the horizontal axis.
    place: fn(&Row) -> f64,
    /// Style of the model's points: it has a result for every radius, but only for integer n.
    look: Look,
}

const RADIUS: Factor = Factor {
    name: "fig3.10",
    head: "h, mm",
    axis: "Radius h in mm",
    place: |row| 1e3 * row.radius_m,
    look: Look::Dashed,
};

const UNKNOTTING_NUMBER: Factor = Factor {
    name: "fig3.11",
    head: "n",
    axis: "Unknotting number n",
    place: |row| row.unknotting_number as f64,
    look: Look::OpenMarks,
};

impl Factor {
    /// Writes the inversion points.
    fn write(&self, page: &mut Page, rows: &[Row]) -> Result<()> {
        page.text(
            "The simplified knot (φ = π/3, ε = 0.7, ends of the loop on the axis, no friction, see \
             fig3.9) has no other length than l_k, so that its l̄_k is the same for every radius. \
             φ and ε are those of knots of n = 3 near their inversion, and are used for every n. A \
             trefoil has no fold, and does not invert.",
        );
        let ratio = |model: Option<f64>, row: &Row| Some(model? / row.simulated?);
        page.table(columns! { row in rows;
            self.head => ((1e6 * (self.place)(row)).round() / 1e6).to_string(),
            "full simulation" => number(row.simulated, 1),
            "clamped" => number(row.clamped, 1),
            "its ratio" => number(ratio(row.clamped, row), 3),
            "free to spin" => number(row.free_to_spin, 1),
            "its ratio" => number(ratio(row.free_to_spin, row), 3),
        });
        Ok(())
    }

    fn figures(&self, rows: &[Row]) -> Vec<PageFigure> {
        let over = |name: &str, look: Look, value: fn(&Row) -> Option<f64>| {
            curve(name, rows, |row| ((self.place)(row), value(row))).looking(look)
        };
        let curves = [
            over("full simulation, μ = 0.1", Look::Marks, |row| {
                row.simulated
            }),
            over("simplified, ends of the loop clamped", self.look, |row| {
                row.clamped
            }),
            over("simplified, free to spin", self.look, |row| {
                row.free_to_spin
            }),
        ];
        vec![PageFigure::new(
            self.name,
            "Inversion points of the full simulation and of the simplified knot",
            line_plots([plot("l̄_{k} at the inversion", curves)], self.axis),
        )]
    }
}

fn row(case: &Case<Inversion>) -> Row {
    let number = case.run.unknotting_number;
    let [clamped, free_to_spin] = SPINS.map(|(_, spin)| {
        let fold = SimplifiedKnot::of_thesis(number, spin).inversion();
        fold.map(|fold| fold.length)
    });
    Row {
        unknotting_number: number,
        radius_m: case.run.radius,
        simulated: Inversion::outcome(case).inversion_by_height,
        clamped,
        free_to_spin,
    }
}
