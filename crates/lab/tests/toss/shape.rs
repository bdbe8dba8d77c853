//! Rounded edges: they change how a cube rolls, and their radius can be at most half of the cube's side.

use realgap_simulation::parameter::by_name;
use realgap_simulation::{Experiment, Start, run};

use super::standin::{EXACT, cube, tosses};

fn end_m(experiment: &Experiment) -> nalgebra::Vector3<f64> {
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    *motion.positions_world_m().last().unwrap()
}

#[test]
fn a_cube_with_rounded_edges_stops_elsewhere_but_rests_at_the_same_height() {
    let mut sharp = cube();
    sharp.start = Start::State(tosses(&cube(), &EXACT, 1)[0].truth);
    sharp.duration_s = 3.0;
    let radius = by_name("body.edge_radius_m").unwrap();
    let round = radius.apply(&sharp, 0.004).unwrap();
    let (a, b) = (end_m(&sharp), end_m(&round));
    assert!((a - b).norm() > 1e-4, "{a} {b}");
    assert!(
        (a.z - 0.0524).abs() < 5e-4 && (b.z - 0.0524).abs() < 5e-4,
        "{a} {b}"
    );
    assert_eq!(end_m(&radius.apply(&sharp, 0.0).unwrap()), a);
}

#[test]
fn an_edge_radius_above_half_of_the_side_is_refused_with_the_limit() {
    let round = by_name("body.edge_radius_m")
        .unwrap()
        .apply(&cube(), 0.06)
        .unwrap();
    let error = run(&round).unwrap_err().to_string();
    assert!(
        error.contains("body.edge_radius_m") && error.contains("0.0524"),
        "{error}"
    );
}
