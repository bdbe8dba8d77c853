//! Range sensor of a two-wheel robot, and its decision whether an obstacle is near.

use rand::RngExt as _;

use super::Vehicle;
use super::drive::{Drive, EPOCH_S};
use realgap_core::random::Generator;
use realgap_sensing::arena::Arena;
use realgap_sensing::belief::Belief;
use realgap_sensing::range::{Beam, RangeSensor, ReadingUnit};

/// Number of cells of a belief over the sensor's range.
const CELLS: usize = 121;

/// The sensor during a run: the time of its next reading, and the belief from past readings.
pub(super) struct VehicleSensor<'a> {
    vehicle: &'a Vehicle,
    drive: Drive,
    next_s: f64,
    belief: Option<(Belief, usize)>,
    rng: Option<Generator>,
    alarms: Option<Generator>,
    /// Time of driving straight until the next false alarm, seconds.
    alarm_s: f64,
}

impl<'a> VehicleSensor<'a> {
    /// A sensor whose first reading is at a random time within its sampling time; without noise the first reading is at time 0,
    /// and there are no false alarms.
    pub(super) fn new(
        vehicle: &'a Vehicle,
        drive: Drive,
        [mut rng, mut alarms]: [Option<Generator>; 2],
    ) -> Self {
        let alarm_s = until_alarm_s(&drive, &mut alarms);
        let share: f64 = rng.as_mut().map_or(0.0, |rng| rng.random());
        Self {
            vehicle,
            drive,
            next_s: share * drive.sampling_s,
            belief: None,
            rng,
            alarms,
            alarm_s,
        }
    }

    /// Discards the belief from past readings when a new command begins.
    pub(super) fn forget(&mut self) {
        self.belief = None;
    }

    /// Whether an obstacle is near according to the readings of this epoch; `None` if there is no reading or no decision yet.
    pub(super) fn is_near(
        &mut self,
        arena: &Arena,
        time_s: f64,
        place_m: [f64; 2],
        heading_rad: f64,
    ) -> Option<bool> {
        let sees = self.sees(arena, time_s, place_m, heading_rad);
        self.alarm_s -= EPOCH_S;
        if self.alarm_s > 0.0 {
            return sees;
        }
        self.alarm_s = until_alarm_s(&self.drive, &mut self.alarms);
        Some(true)
    }

    fn sees(
        &mut self,
        arena: &Arena,
        time_s: f64,
        place_m: [f64; 2],
        heading_rad: f64,
    ) -> Option<bool> {
        if time_s + 1e-9 < self.next_s {
            return None;
        }
        self.next_s += self.drive.sampling_s;
        let (sin, cos) = heading_rad.sin_cos();
        let ahead = self.drive.sensor_ahead_m;
        let eye_m = [place_m[0] + ahead * cos, place_m[1] + ahead * sin];
        let hit = arena.cast(eye_m, heading_rad);
        let (near_m, far_m) = self.vehicle.sensor.range_m();
        // Readings beyond the sensor's range are ignored.
        let hit = hit.filter(|hit| hit.distance_m <= far_m)?;
        if self.drive.ideal_sensor > 0.5 {
            return Some(hit.distance_m < self.drive.threshold_m);
        }
        let beam = Beam {
            // At distances below its range the sensor reads as at the near end of its range.
            distance_m: hit.distance_m.max(near_m),
            incidence_rad: hit.incidence_rad,
            offset_rad: hit.offset_rad,
        };
        let reading = self.read(&beam)?;
        if self.drive.filter_readings < 0.5 {
            return Some(self.reads_near(reading));
        }
        self.believe(reading)
    }

    fn read(&mut self, beam: &Beam) -> Option<f64> {
        let sensor = &*self.vehicle.sensor;
        let mean = sensor.mean(beam);
        let reading = match &mut self.rng {
            Some(rng) => sensor.draw(beam, rng)?,
            None => mean,
        };
        Some(mean + self.drive.sensor_noise * (reading - mean))
    }

    /// Whether a reading means a distance below the threshold: lengths are compared directly, other readings with the mean
    /// reading at the threshold.
    fn reads_near(&self, reading: f64) -> bool {
        let sensor = &*self.vehicle.sensor;
        if let ReadingUnit::Length(unit) = sensor.reading_unit {
            return reading * unit.metres() < self.drive.threshold_m;
        }
        let at = |distance_m: f64| sensor.mean(&Beam::straight(distance_m));
        let edge = at(self.drive.threshold_m);
        let is_falling = at(0.9 * self.drive.threshold_m) > edge;
        if is_falling {
            reading > edge
        } else {
            reading < edge
        }
    }

    fn believe(&mut self, reading: f64) -> Option<bool> {
        let sensor = &*self.vehicle.sensor;
        let (near_m, far_m) = sensor.range_m();
        let (belief, count) = self
            .belief
            .get_or_insert_with(|| (Belief::uniform(near_m, far_m, CELLS), 0));
        belief.observe(sensor, reading);
        *count += 1;
        if (*count as f64) < self.drive.filter_readings {
            return None;
        }
        let mean_m = belief.mean_m();
        self.belief = None;
        Some(mean_m < self.drive.threshold_m)
    }
}

/// Time until the next false alarm, seconds; exponentially distributed because alarms are independent.
fn until_alarm_s(drive: &Drive, alarms: &mut Option<Generator>) -> f64 {
    match alarms {
        Some(rng) if drive.false_alarm_hz > 0.0 => {
            -libm::log(1.0 - rng.random::<f64>()) / drive.false_alarm_hz
        }
        _ => f64::INFINITY,
    }
}
