//! Tables and JSON files of all runs.

use super::Column;

pub(super) const SERIES: &[Column] = columns! {
    "time_s": "Simulated time, s; on a path of equilibria, the path parameter.",
    "step_s": "Size of the last time step, s; empty if none was taken.",
    "steps": "Accepted time steps since the previous row.",
    "newton_iterations": "Mean number of Newton iterations per step, including those of repeated steps.",
    "fluid_iterations": "Mean number of Krylov iterations of the fluid solves per step.",
    "contacts": "Contacts with a force at the end of the last step; empty if no step was taken.",
    "min_distance_m": "Distance of the two bodies that are nearest to contact, m: between centrelines, which touch at the \
        sum of their radii, or from a centreline to a plane. Only rods near contact are included; empty if none are near.",
    "kinetic_energy_j": "Kinetic energy, J.",
    "stretching_energy_j": "Elastic energy of stretching, including that of springs between nodes, J.",
    "bending_energy_j": "Elastic energy of bending, including that of springs about hinges, J.",
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

pub(super) const CONTACTS: &[Column] = columns! {
    "time_s": "Simulated time, s.",
    "first": "Name of the rod or free body.",
    "first_node": "Node at which its edge in contact begins, or node in contact; empty for a free body.",
    "second": "Name of the other rod, free body or obstacle, or \"plane 0\", \"plane 1\", ...",
    "second_node": "Node at which its edge in contact begins; empty for what is not a rod.",
    "x_m": "Place on the surface of the first along x, m.",
    "y_m": "Place along y, m.",
    "z_m": "Place along z, m.",
    "normal_x": "Unit normal, from the second to the first, along x.",
    "normal_y": "Its component along y.",
    "normal_z": "Its component along z.",
    "gap_m": "Distance between the surfaces, m.",
    "normal_force_n": "Normal force, N.",
    "friction_x_n": "Friction on the first along x, N.",
    "friction_y_n": "Friction on the first along y, N.",
    "friction_z_n": "Friction on the first along z, N.",
};

pub(super) const END_STATE: &[Column] = columns! {
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "x_m": "Position along x, m.",
    "y_m": "Position along y, m.",
    "z_m": "Position along z, m.",
    "director_x": "First material director of the edge that starts at the node, along x; empty at the last node of an open rod.",
    "director_y": "Its component along y.",
    "director_z": "Its component along z.",
    "twist_rad": "Twist between the edges on either side of the node, rad, including whole turns; 0 at free ends.",
    "velocity_x_m_per_s": "Velocity along x, m/s.",
    "velocity_y_m_per_s": "Velocity along y, m/s.",
    "velocity_z_m_per_s": "Velocity along z, m/s.",
    "spin_rad_per_s": "Rate at which the edge that starts at the node spins about itself, rad/s.",
    "wall_tangent_x": "Tangent of the clamp at the node, or of the rigid joint, hinge or body to which the rod is clamped there, \
        along x; empty if nothing held the frame of the rod.",
    "wall_tangent_y": "Its component along y.",
    "wall_tangent_z": "Its component along z.",
    "wall_director_x": "First material director there, along x.",
    "wall_director_y": "Its component along y.",
    "wall_director_z": "Its component along z.",
    "wall_spin_x_rad_per_s": "Angular velocity of the joint or body about x, rad/s; empty at clamps.",
    "wall_spin_y_rad_per_s": "Its component about y.",
    "wall_spin_z_rad_per_s": "Its component about z.",
};

pub(super) const SUMMARY: &[Column] = columns! {
    "case": "Id of the case: its values and a short hash; `main` for a single run.",
    "status": "How the case ended: finished, or pending, running, interrupted, time-limit (all can continue), no-convergence, \
        unphysical, invalid, failed.",
    "simulated_time_s": "Simulated time reached, s.",
    "steps": "Accepted time steps.",
    "retries": "Number of times that a step was halved before it was accepted.",
    "newton_iterations_mean": "Mean number of Newton iterations per step.",
    "newton_iterations_mean_with_contact": "Mean number of Newton iterations per step with contact; empty if there was none.",
    "fluid_iterations_mean": "Mean number of Krylov iterations of the fluid solves per step.",
    "steps_with_contact": "Number of steps that ended with contact.",
    "first_contact_s": "End of the first step with contact, s; empty if there was none.",
    "min_distance_m": "Smallest distance of two bodies during the run, m: of two centrelines, or of one from a plane \
        or an obstacle; empty if none came near.",
    "min_distance_ratio": "Ratio of that distance to the one at which the surfaces touch, which is the sum of the radii, or the \
        radius of the rod at a plane or an obstacle: below 1 they penetrate each other.",
    "mean_gap_m": "Mean gap between touching surfaces, m: distance of the centrelines minus the sum of the radii (from a \
        plane or an obstacle, minus the radius). The mean is over all pairs of edges and all nodes at planes with a contact \
        force, weighted by their normal forces, and then over the outputs with contact; negative if they penetrate, empty \
        if nothing touches.",
    "elastic_energy_j": "Energy of stretching, bending and twisting at the last output, J.",
    "gravitational_energy_j": "Potential of gravity at the last output, J.",
    "critical_parameter": "Path parameter of the first fold, bifurcation or onset of flutter; empty if there is no \
                           path, or no such point on it.",
    "remarks": "Remarks on the case, sentences joined by \"; \": strains beyond the theory of rods (stretch by more \
                than 5 %, outer fibres by bending or twist by more than 20 %), spurious energy, steps far smaller than \
                requested, and remarks of the experiment; empty if there are none.",
};

pub(super) const TIMINGS: &[Column] = columns! {
    "case": "Id of the case.",
    "wall_time_s": "Wall time of all calls that worked on the case, s.",
    "wall_time_with_contact_s": "Part of the wall time spent in steps with contact, s.",
    "cpu_time_s": "Processor time of all threads, s; empty if the system does not report it.",
    "peak_memory_bytes": "Largest resident memory of the process, bytes; in a sweep, the same for all cases of a process.",
};

pub(super) const BRANCH: &[Column] = columns! {
    "branch": "Number of the branch; branch 0 begins at the start of the path.",
    "parameter": "The path parameter, which replaces time.",
    "parameter_error": "Width of the last bracket around a critical point; 0 at other points.",
    "displacement_rms_m": "Root mean square of the nodes' displacement from their placed positions, m.",
    "elastic_energy_j": "Energy of stretching, bending and twisting, J.",
    "energy_j": "Elastic energy with the potentials of contact and gravity, J; without those of other loads.",
    "negative_pivots": "Negative pivots of the Hessian: independent directions in which the energy decreases. Under forces \
        without an energy, growing small motions; an oscillating one counts twice.",
    "stable": "Whether there are no negative pivots: true or false.",
    "lowest_eigenvalue_n_per_m": "Lowest eigenvalue of the Hessian, N/m; empty under forces without an energy.",
    "growth_rate_per_s": "Rate at which the fastest small motion grows, 1/s, 0 if none does; empty if forces have an energy.",
    "frequency_hz": "Frequency of that motion, Hz, 0 if it diverges without oscillating; for a stable equilibrium the lowest frequency.",
    "kind": "regular, fold (the parameter turns back), bifurcation (another branch crosses) or flutter (oscillations begin to \
        grow, or cease to).",
    "newton_iterations": "Newton iterations since the previous point.",
};

pub(super) const SEARCH: &[Column] = columns! {
    "from": "One end of the last interval.",
    "to": "The other end.",
    "evaluations": "Number of cases that the search evaluated.",
    "failure": "Reason why the search failed; empty if it succeeded.",
};

pub(super) const MANIFEST: &[Column] = columns! {
    "version": "Version of the program.",
    "commit": "Commit of the program: that of the clone from which it was built, or the value of RODLAB_COMMIT at build time; otherwise null.",
    "command_line": "The last command line that wrote to the directory.",
    "name": "Short name of the scenario.",
    "experiment": "Experiment of the scenario.",
    "title": "Title of the scenario.",
    "scenario": "The resolved scenario as TOML, as in scenario.toml; absent where it is longer than 64 KiB.",
    "scenario_hash": "BLAKE3 hash of the scenario without its title, by which the directory is recognised.",
    "rods": "Name, number of nodes, radius (m) of each rod, and whether it is closed.",
    "host": "Name of the machine.",
    "threads": "Number of threads that the run could use.",
    "start": "When the run was first started.",
    "end": "When the run last ended; null while it runs, or if it was killed.",
    "continuations": "Number of times that the run was continued from a checkpoint.",
    "seeds": "Seeds of random choices by name.",
    "cases": "Cases by id: status, outcome (the numbers of summary.csv), cost (wall_time in s, ...) and error, the reason why the \
        case ended early. A single run is the case `main`.",
    "files": "Length (bytes) and BLAKE3 hash of each file that grew during the run, at its end; for `vtk`, those of all \
        frames, one after the other. Running the same command again detects files that were removed or changed.",
};

pub(super) const SLURM: &[Column] = columns! {
    "tasks": "Number of tasks of the job array.",
    "jobs": "Numbers of the jobs, in the order in which they were submitted.",
};
