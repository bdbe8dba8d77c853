//! Tests that the outcome of a message depends on its strength only, not on other messages or on the cache.

use rayon::prelude::*;
use realgap_sensing::radio::{
    Delivery, Link, MOST_PAIRS, Message, RadioModel, Service, ServiceOptions, ServiceReport,
    ShadowField,
};

use super::{known, rooms};

#[test]
fn messages_are_delivered_by_strength_whatever_else_is_sent() {
    let (arena, model) = (
        rooms(),
        RadioModel {
            sensitivity_dbm: -64.0,
            ..known()
        },
    );
    let message = |number: u64| Message {
        number,
        from_m: [1.0, 1.0, 0.3],
        to_m: [9.0, 1.0, 0.3],
        at_s: 2.0,
    };
    let quiet = Service::new(
        &model,
        &arena,
        ServiceOptions {
            noise: false,
            ..ServiceOptions::default()
        },
    )
    .unwrap();
    let link = Link::new(&arena, message(0).from_m, message(0).to_m);
    let expected = model.strength_dbm(&link);
    assert!(expected < -64.0);
    assert_eq!(
        quiet.send(&message(0)),
        Delivery::TooWeak {
            strength_dbm: expected
        }
    );
    let options = ServiceOptions {
        seed: 2,
        loss_half_db: 2.0,
        loss_width_db: 2.0,
        latency_s: 0.01,
        latency_sd_s: 0.002,
        ..ServiceOptions::default()
    };
    let service = Service::new(&model, &arena, options).unwrap();
    let sent: Vec<_> = (0..4000)
        .map(|k| (message(k), service.send(&message(k))))
        .collect();
    // Order does not matter.
    for (message, delivery) in sent.iter().rev().step_by(97) {
        assert_eq!(service.send(message), *delivery);
    }
    let report = ServiceReport::new(&sent);
    assert_eq!(report.delivered + report.lost + report.too_weak, 4000);
    assert!(
        report.delivered > 100 && report.lost > 100 && report.too_weak > 100,
        "{report}"
    );
    for (_, delivery) in &sent {
        match delivery {
            Delivery::TooWeak { strength_dbm } => assert!(*strength_dbm < -64.0),
            Delivery::Delivered { at_s, strength_dbm } => {
                assert!(*strength_dbm >= -64.0 && (2.0..2.03).contains(at_s));
            }
            Delivery::Lost { strength_dbm } => assert!(*strength_dbm >= -64.0),
        }
    }
    // The share of messages that are lost above the sensitivity follows the loss curve.
    let strong = sent.iter().filter_map(|(_, delivery)| match delivery {
        Delivery::Delivered { strength_dbm, .. } | Delivery::Lost { strength_dbm } => {
            Some(service.loss(strength_dbm + 64.0))
        }
        Delivery::TooWeak { .. } => None,
    });
    let expected: f64 = strong.sum();
    assert!((report.lost as f64 - expected).abs() < 4.0 * expected.sqrt());
    assert!((service.loss(2.0) - 0.5).abs() < 1e-12);
}

#[test]
fn the_cache_of_pairs_changes_no_bit_in_any_order_on_any_number_of_threads() {
    let arena = rooms();
    let model = RadioModel {
        fading_sd_db: 0.0,
        ..known()
    };
    let places: Vec<[f64; 3]> = (0..12)
        .map(|k| [0.7 * f64::from(k) + 0.4, f64::from(k * 5 % 12) * 0.8, 0.3])
        .collect();
    let message = |number: usize| Message {
        number: number as u64,
        from_m: places[number % 12],
        to_m: places[number / 12 % 12],
        at_s: 0.0,
    };
    let options = ServiceOptions::default();
    let field = ShadowField::new(options.seed, model.shadowing_distance_m);
    let strength = |service: &Service<'_>, message: &Message| match service.send(message) {
        Delivery::Delivered { strength_dbm, .. }
        | Delivery::TooWeak { strength_dbm }
        | Delivery::Lost { strength_dbm } => strength_dbm.to_bits(),
    };
    let computed = |message: &Message| {
        let [a, b] = [message.from_m, message.to_m].map(|[x, y, _]| [x, y]);
        let link = Link::new(&arena, message.from_m, message.to_m);
        (model.strength_dbm(&link) + model.shadowing_sd_db * field.at(a, b)).to_bits()
    };
    let expected: Vec<u64> = (0..144).map(|k| computed(&message(k))).collect();
    let service = Service::new(&model, &arena, options).unwrap();
    for number in (0..432).rev() {
        let seen = strength(&service, &message(number));
        assert_eq!(seen, expected[number % 144], "{number}");
    }
    assert_eq!(service.kept_pairs(), 144);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let service = Service::new(&model, &arena, options).unwrap();
        let seen: Vec<u64> = pool.build().unwrap().install(|| {
            let numbers = (0..1440_usize).into_par_iter();
            numbers
                .map(|k| strength(&service, &message(k * 7)))
                .collect()
        });
        for (k, seen) in seen.into_iter().enumerate() {
            assert_eq!(seen, expected[k * 7 % 144], "{k} on {threads} threads");
        }
    }
}

#[test]
fn a_service_caches_at_most_the_stated_number_of_pairs() {
    let (arena, model) = (rooms(), known());
    let options = ServiceOptions {
        noise: false,
        ..ServiceOptions::default()
    };
    let service = Service::new(&model, &arena, options).unwrap();
    let message = |number: usize| Message {
        number: number as u64,
        from_m: [1e-4 * number as f64, 1.0, 0.3],
        to_m: [9.0, 9.0, 0.3],
        at_s: 0.0,
    };
    let first = service.send(&message(0));
    for number in 1..MOST_PAIRS + MOST_PAIRS / 2 {
        service.send(&message(number));
        assert!(service.kept_pairs() <= MOST_PAIRS);
    }
    assert_eq!(service.kept_pairs(), MOST_PAIRS);
    // A pair that is no longer cached is computed again with the same result.
    assert_eq!(service.send(&message(0)), first);
}
