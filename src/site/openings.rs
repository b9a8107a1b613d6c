//! Openings of guide pages on the site: a picture and a first command.

/// Page of the guide, picture below `results/reproduced`, caption, command.
const OPENINGS: &[[&str; 4]] = &[
    [
        "getting_started",
        "flagella_quick.svg",
        "Three flagella bundle in a fluid",
        "rodlab run flagella_quick",
    ],
    [
        "scenarios",
        "y_junction.svg",
        "Three rods meet in a joint",
        "rodlab init scene",
    ],
    [
        "parameters",
        "pile.png",
        "Two hundred rods from one table",
        "rodlab expand pile",
    ],
    [
        "sections",
        "fishing_rod.png",
        "A fishing rod bends as it casts a lure",
        "rodlab run fishing_rod",
    ],
    [
        "actuation",
        "swimmer.svg",
        "A flagellum pushes a cell forward",
        "rodlab run swimmer",
    ],
    [
        "plasticity",
        "bent_wire.svg",
        "A wire is bent, let go, and springs back",
        "rodlab run bent_wire",
    ],
    [
        "tendons",
        "tendon_arm.svg",
        "Three tendons bend a backbone",
        "rodlab run tendon_arm",
    ],
    [
        "sheaths",
        "guidewire.png",
        "A guidewire is fed into a winding vessel",
        "rodlab run guidewire",
    ],
    [
        "contact",
        "pile.png",
        "Two hundred rods in a heap",
        "rodlab run pile",
    ],
    [
        "smooth_contact",
        "inversion_n3.svg",
        "The loop of an overhand knot snaps across its braid",
        "rodlab run trefoil --set contact.geometry=smooth",
    ],
    [
        "free_bodies",
        "gripper.svg",
        "A wire is pulled out of a gripper",
        "rodlab run gripper",
    ],
    [
        "joints",
        "gridshell.svg",
        "A gridshell of joined rods",
        "rodlab run gridshell",
    ],
    [
        "currents",
        "tumbling_filament.svg",
        "A filament buckles and tumbles in a shear flow",
        "rodlab run tumbling_filament",
    ],
    [
        "springs",
        "ring_on_rope.svg",
        "A ring slides along a rope",
        "rodlab explain joints.break_at",
    ],
    [
        "networks",
        "net.svg",
        "A net of joined threads",
        "rodlab run net",
    ],
    [
        "obstacles",
        "mesh_obstacle.svg",
        "A rod on a mesh",
        "rodlab run mesh_obstacle",
    ],
    [
        "time",
        "auto-steps/auto-steps.svg",
        "Automatic steps over 250 s, two and ten flagella",
        "rodlab check elastic_pendulum",
    ],
    [
        "exit_codes",
        "plectoneme.svg",
        "A twisted rod writhes",
        "rodlab run twisted_ring --timeout \"10 min\"",
    ],
    [
        "sweeps",
        "tab2.2/tab2.2.svg",
        "Two flagella with growing friction",
        "rodlab run cantilever_sweep",
    ],
    [
        "cluster",
        "fig6.2/section_kappa_tau.svg",
        "Where 328 helices lose stability",
        "rodlab submit cantilever_sweep --print",
    ],
    [
        "equilibria",
        "euler_column.svg",
        "Euler's column buckles",
        "rodlab run euler_column",
    ],
    [
        "sensitivity",
        "deployment-errors/deployment-errors_length.svg",
        "Error of a laid rod over an error of its stiffness",
        "rodlab sensitivity spring_board.toml --to material.density",
    ],
    [
        "photographs",
        "wire_loop.svg",
        "Points of a photograph less the fitted loop of a wire",
        "rodlab measure rod photo.png --pixel \"0.2 mm\"",
    ],
    [
        "knots",
        "trefoil.svg",
        "A trefoil is pulled tight",
        "rodlab run trefoil",
    ],
    [
        "helices",
        "fig6.2/section_kappa_tau.svg",
        "Where clamped helices lose stability",
        "rodlab run helix_boundary",
    ],
    [
        "deployment",
        "tab5.2/tab5.2_rod1.svg",
        "A rod laid along patterns",
        "rodlab plan deployment --pattern A --out results/a",
    ],
    [
        "tying",
        "tab5.4/tab5.4_trefoil.svg",
        "A trefoil tied by two grippers",
        "rodlab run tied_trefoil",
    ],
    [
        "folding",
        "fig4.11/fig4.11_ours.svg",
        "Folds of sheets",
        "rodlab fold --paper a4 --simulate",
    ],
    [
        "training",
        "fig4.11/fig4.11_ours.svg",
        "Folds of sheets",
        "rodlab dataset folding_dataset",
    ],
    [
        "fluid",
        "flagella_quick.svg",
        "Three flagella bundle in a fluid",
        "rodlab run flagella_m5",
    ],
    [
        "results",
        "view.png",
        "Results in the browser",
        "rodlab explain series",
    ],
    [
        "probes",
        "whip_with_disk.svg",
        "A whip with a disk",
        "rodlab explain probes",
    ],
    [
        "identification",
        "wire_loop.svg",
        "Points of a photograph less the fitted loop of a wire",
        "rodlab identify wire_loop --data black_0.csv --fit parameters.ei",
    ],
    [
        "design",
        "curl.svg",
        "A curl in equilibrium, and the same rod without loads",
        "rodlab design curl --shape curl.csv --vary rods.curl.natural_curvature",
    ],
    [
        "figures",
        "reef.svg",
        "A reef knot, drawn by `rodlab plot`",
        "rodlab plot results/reef",
    ],
    [
        "exchange",
        "plectoneme.svg",
        "A plectoneme, whose tube `rodlab export` writes for Blender",
        "rodlab export results/driven_plectoneme --format gltf --out plectoneme.glb",
    ],
    [
        "robots",
        "tab5.2-cell/tab5.2-cell_laid.svg",
        "Patterns laid by an arm",
        "rodlab check gantry",
    ],
    [
        "streaming",
        "tab5.2-cell/tab5.2-cell_laid.svg",
        "Patterns laid by an arm",
        "rodlab stream joints.csv --cell gantry --watch",
    ],
    [
        "cell",
        "tab5.4/tab5.4_trefoil.svg",
        "A knot tied by two arms",
        "rodlab deploy --pattern A.svg",
    ],
    [
        "bench",
        "tab5.2-cell/tab5.2-cell_laid.svg",
        "Patterns laid by an arm",
        "rodlab deploy --pattern line:0.2 --rod green_vps",
    ],
    [
        "virtual_cell",
        "tab5.2-cell/tab5.2-cell_laid.svg",
        "Patterns laid by an arm",
        "rodlab cell serve --rod green_vps",
    ],
    [
        "exploration",
        "fig6.6-robot/fig6.6-robot_found.svg",
        "Stability found by an arm",
        "rodlab explore --rod nitinol_wire --section 3",
    ],
    [
        "vision",
        "trace_rods.png",
        "Rods traced in a photograph",
        "rodlab trace photograph.jpg --out traced",
    ],
    [
        "theory",
        "fig3.9/fig3.9_equilibria.svg",
        "Energy and equilibria of the simplified knot",
        "rodlab solve helix --direction=1,1,-1",
    ],
    [
        "accuracy",
        "knot-convergence/knot-convergence.svg",
        "Convergence of a knot",
        "rodlab verify",
    ],
    [
        "performance",
        "cost/cost.svg",
        "Cost of a step over flagella, rods in a heap and edges",
        "rodlab reproduce cost --quick",
    ],
    [
        "python",
        "y_junction.svg",
        "Three rods meet in a joint",
        "rodlab guide python",
    ],
    [
        "environments",
        "fig4.10/fig4.10_ways.svg",
        "Paths of a gripper that folds letter paper",
        "rodlab dataset Folding --format npz --count 20 --no-pictures",
    ],
    [
        "library",
        "net.svg",
        "A net of joined threads",
        "cargo doc --open",
    ],
];

/// The text of a page with its opening after the title. Pages without an opening are unchanged. A
/// page whose first block of code is a command keeps this command.
pub fn opened(path: &str, text: &str) -> String {
    let name = path.strip_prefix("src/guide/");
    let name = name.and_then(|name| name.strip_suffix(".md"));
    let opening = OPENINGS.iter().find(|[page, ..]| Some(*page) == name);
    match (opening, text.split_once('\n')) {
        (Some([_, picture, words, command]), Some((title, rest))) => {
            let first = rest.split_once("```").map(|(_, block)| block);
            let command = if first.is_some_and(|block| block.starts_with("sh")) {
                String::new()
            } else {
                format!("\n```sh\n{command}\n```\n")
            };
            let picture = format!("![{words}](../../results/reproduced/{picture})");
            format!("{title}\n\n{picture}\n{command}{rest}")
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::PAGES;
    use std::path::Path;

    #[test]
    fn every_page_of_the_guide_opens_with_a_picture_and_a_command() {
        let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reproduced");
        for page in PAGES {
            let path = format!("src/guide/{}.md", page.topic().replace('-', "_"));
            let text = opened(&path, page.text);
            assert!(
                text.starts_with(&format!("# {}\n\n![", page.title())),
                "{path}"
            );
            assert!(text.contains("\n```sh"), "{path}");
        }
        for [page, picture, ..] in OPENINGS {
            assert!(pictures.join(picture).is_file(), "{page}: {picture}");
        }
    }
}
