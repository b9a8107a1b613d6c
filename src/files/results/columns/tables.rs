//! Tables and JSON files of all runs.

use super::Column;

pub(super) const SERIES: &[Column] = columns! {
    "time_s": "Simulated time, s; of a path of equilibria, its parameter.",
    "step_s": "Size of the last time step, s; empty where none was taken.",
    "steps": "Accepted time steps since the row before.",
    "newton_iterations": "Mean number of Newton iterations per step, those of repeated steps included.",
    "fluid_iterations": "Mean number of Krylov iterations of the fluid solves per step.",
    "contacts": "Contacts with a force at the end of the last step; empty where no step was taken.",
    "min_distance_m": "Distance of the two bodies that are nearest to contact, m: between centrelines, which touch at the \
        sum of their radii, or from a centreline to a plane. Only rods near contact are included; empty if none is near.",
    "kinetic_energy_j": "Kinetic energy, J.",
    "stretching_energy_j": "Elastic energy of stretching, that of springs between nodes included, J.",
    "bending_energy_j": "Elastic energy of bending, that of springs about hinges included, J.",
    "twisting_energy_j": "Elastic energy of twisting, J.",
    "contact_energy_j": "Potential of the contact forces, J; 0 for rigid contact.",
    "gravitational_energy_j": "Potential of gravity, J, measured from the origin.",
};

pub(super) const NODES: &[Column] = columns! {
    "time_s": "Simulated time, s.",
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "x_m": "Position along x, m.",
    "y_m": "Position along y, m.",
    "z_m": "Position along z, m.",
    "theta_rad": "Angle of the material frame from the reference frame on the edge that starts at the node, rad; empty at \
        the last node of an open rod.",
};

pub(super) const NODE_FORCES: &[Column] = columns! {
    "time_s": "Simulated time, s.",
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "velocity_x_m_per_s": "Velocity along x, m/s.",
    "velocity_y_m_per_s": "Velocity along y, m/s.",
    "velocity_z_m_per_s": "Velocity along z, m/s.",
    "fluid_force_x_n": "Force of the fluid on the node along x, N; 0 without a fluid.",
    "fluid_force_y_n": "Force of the fluid on the node along y, N; 0 without a fluid.",
    "fluid_force_z_n": "Force of the fluid on the node along z, N; 0 without a fluid.",
    "contact_force_x_n": "Contact force on the node along x, friction included, N.",
    "contact_force_y_n": "Contact force on the node along y, friction included, N.",
    "contact_force_z_n": "Contact force on the node along z, friction included, N.",
    "twist_rad_per_m": "Twist per length at the node, rad/m; 0 at free ends.",
};

pub(super) const END_STATE: &[Column] = columns! {
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "x_m": "Position along x, m.",
    "y_m": "Position along y, m.",
    "z_m": "Position along z, m.",
    "director_x": "First material director of the edge that starts at the node, along x; empty at the last node of an open rod.",
    "director_y": "The same along y.",
    "director_z": "The same along z.",
    "twist_rad": "Twist between the edges on either side of the node, rad, whole turns included; 0 at free ends.",
    "velocity_x_m_per_s": "Velocity along x, m/s.",
    "velocity_y_m_per_s": "Velocity along y, m/s.",
    "velocity_z_m_per_s": "Velocity along z, m/s.",
    "spin_rad_per_s": "Rate at which the edge that starts at the node turns about itself, rad/s.",
    "wall_tangent_x": "Tangent at which a clamp held the rod at the node, along x; empty where none held its frame.",
    "wall_tangent_y": "The same along y.",
    "wall_tangent_z": "The same along z.",
    "wall_director_x": "First material director at which it held the rod, along x.",
    "wall_director_y": "The same along y.",
    "wall_director_z": "The same along z.",
};

pub(super) const SUMMARY: &[Column] = columns! {
    "case": "Id of the case: its values and a short hash; `main` for a single run.",
    "status": "How it ended: finished, or pending, running, interrupted, time-limit (all continue), no-convergence, \
        unphysical, invalid, failed.",
    "simulated_time_s": "Simulated time reached, s.",
    "steps": "Accepted time steps.",
    "retries": "Times that a step was halved before it was accepted.",
    "newton_iterations_mean": "Mean number of Newton iterations per step.",
    "newton_iterations_mean_with_contact": "Mean number of Newton iterations per step with contact; empty where there was none.",
    "fluid_iterations_mean": "Mean number of Krylov iterations of the fluid solves per step.",
    "steps_with_contact": "Steps that ended with contact.",
    "first_contact_s": "End of the first step with contact, s; empty where there was none.",
    "min_distance_m": "Smallest distance of two bodies during the run, m: of two centrelines, or of one from a plane \
        or an obstacle; empty where none came near.",
    "min_distance_ratio": "That distance over the one at which their surfaces touch, the sum of their radii, or that of \
        the rod alone at a plane or an obstacle: below 1 they penetrate each other.",
    "mean_gap_m": "Mean gap between touching surfaces, m: distance of the centrelines less the sum of the radii (from a \
        plane or an obstacle, less the radius), mean over all pairs of edges and all nodes at planes that bear force, weighted by \
        their normal forces, then over the outputs with contact; negative where they penetrate, empty where nothing touches.",
    "elastic_energy_j": "Energy of stretching, bending and twisting at the last output, J.",
    "gravitational_energy_j": "Potential of gravity at the last output, J.",
    "critical_parameter": "Path parameter of the first fold, bifurcation or onset of flutter; empty where there is no \
                           path, or none on it.",
    "remarks": "Remarks on the case, sentences joined by \"; \": strains beyond the theory of rods (stretch by more \
                than 5 %, outer fibres by bending or twist by more than 20 %), spurious energy, steps far smaller than \
                requested, and what the experiment adds; empty where there is nothing to remark.",
};

pub(super) const TIMINGS: &[Column] = columns! {
    "case": "Id of the case.",
    "wall_time_s": "Time on the clock, all calls that worked on it together, s.",
    "wall_time_with_contact_s": "The part of it that went into steps with contact, s.",
    "cpu_time_s": "Processor time of all threads, s; empty where the system does not report it.",
    "peak_memory_bytes": "Largest resident memory of the process, bytes; of a sweep, the cases of a process share it.",
};

pub(super) const BRANCH: &[Column] = columns! {
    "branch": "Number of the branch; 0 begins at the start of the path.",
    "parameter": "The path parameter, used in the place of time.",
    "parameter_error": "Width of the last bracket around a critical point; 0 at other points.",
    "displacement_rms_m": "Root mean square of the nodes' displacement from where they were placed, m.",
    "elastic_energy_j": "Energy of stretching, bending and twisting, J.",
    "energy_j": "Elastic energy with the potentials of contact and gravity, J; without that of other loads.",
    "negative_pivots": "Negative pivots of the Hessian: independent directions in which the energy falls; under forces without \
        an energy, small motions that grow, those that oscillate counted twice.",
    "stable": "Whether there are none: true or false.",
    "lowest_eigenvalue_n_per_m": "Lowest eigenvalue of the Hessian, N/m; empty under forces without an energy.",
    "growth_rate_per_s": "Rate at which the fastest small motion grows, 1/s, 0 where none does; empty where forces have an energy.",
    "frequency_hz": "Its frequency, Hz, 0 where it diverges without oscillating; of a stable equilibrium the lowest frequency.",
    "kind": "regular, fold (the parameter turns back), bifurcation (another branch crosses) or flutter (oscillations begin to \
        grow, or cease to).",
    "newton_iterations": "Newton iterations from the point before.",
};

pub(super) const SEARCH: &[Column] = columns! {
    "from": "One end of the last interval.",
    "to": "The other end.",
    "evaluations": "Cases that the search took.",
    "failure": "Why it found nothing; empty if it succeeded.",
};

pub(super) const MANIFEST: &[Column] = columns! {
    "version": "Version of the program.",
    "commit": "Commit of the program: of the clone that it was built from, or the value of RODLAB_COMMIT at build time; else null.",
    "command_line": "The last command line that wrote here.",
    "name": "Short name of the scenario.",
    "experiment": "Its experiment.",
    "title": "Its title.",
    "scenario": "The resolved scenario as TOML, as in scenario.toml.",
    "scenario_hash": "BLAKE3 hash of it without its title, by which the directory is recognised.",
    "rods": "Name, number of nodes, radius (m) of each rod, and whether it is closed.",
    "host": "Name of the machine.",
    "threads": "Threads that the run could use.",
    "start": "When the run was first started.",
    "end": "When it last ended; null while it runs, or where it was killed.",
    "continuations": "Times that the run was continued from a checkpoint.",
    "seeds": "Seeds of random choices by name.",
    "cases": "By id: status, outcome (the numbers of summary.csv), cost (wall_time in s, ...) and error, the reason why it ended \
        early. A single run is the case `main`.",
    "files": "Length (bytes) and BLAKE3 hash of each file that grew during the run, as it was left; of `vtk`, those of all \
        frames one after the other. Running the same command again detects files that were removed or changed.",
};

pub(super) const SLURM: &[Column] = columns! {
    "tasks": "Number of tasks of the job array.",
    "jobs": "Numbers of the jobs, in the order in which they were submitted.",
};
