//! Makes a synthetic log of a scanner in a square room.

/// The log of a robot that winds through a square room, with a scanner that looks all round or to the front only.
pub fn room(scans: usize, all_round: bool) -> String {
    let step = 10;
    let (from, to) = if all_round { (0, 360) } else { (-90, 91) };
    let beams: Vec<i32> = (from..to).step_by(step).collect();
    let names: Vec<String> = beams.iter().map(|b| format!("range_{b}_m")).collect();
    let mut text = format!("t_s,x_m,y_m,heading_rad,{}\n", names.join(","));
    for k in 0..scans {
        let t = k as f64 / scans as f64;
        let (x, y, heading) = (3.0 * (9.0 * t).sin(), 3.0 * (14.0 * t).cos(), 40.0 * t);
        let range = |beam: &i32| {
            let (sin, cos) = (heading + f64::from(*beam).to_radians()).sin_cos();
            let to_x = if cos > 0.0 {
                (5.0 - x) / cos
            } else {
                (-5.0 - x) / cos
            };
            let to_y = if sin > 0.0 {
                (5.0 - y) / sin
            } else {
                (-5.0 - y) / sin
            };
            to_x.min(to_y).to_string()
        };
        let ranges: Vec<String> = beams.iter().map(range).collect();
        text += &format!(
            "{},{x},{y},{heading},{}\n",
            0.25 * k as f64,
            ranges.join(",")
        );
    }
    text
}
