//! What other programs see of a trace.

use super::{file::write, sample};
use crate::support::folder;
use serde_json::Value as Json;
use soifra_runtime::{Record, Time};
use std::{collections::BTreeMap, fs};

/// Checks `value` against the parts of JSON Schema that our schemas use.
fn check(schema: &Json, value: &Json, place: &str) {
    let types: Vec<&str> = match &schema["type"] {
        Json::String(s) => vec![s],
        Json::Array(a) => a.iter().filter_map(Json::as_str).collect(),
        _ => vec![],
    };
    let fits = |t: &&str| match *t {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        _ => false,
    };
    assert!(types.is_empty() || types.iter().any(fits), "{place}: {value} is no {types:?}");
    if let Some(c) = schema.get("const") {
        assert_eq!(c, value, "{place}");
    }
    if let (Some(items), Some(values)) = (schema.get("items"), value.as_array()) {
        values.iter().enumerate().for_each(|(i, v)| check(items, v, &format!("{place}[{i}]")));
    }
    if let Some(object) = value.as_object() {
        for name in schema["required"].as_array().into_iter().flatten() {
            assert!(object.contains_key(name.as_str().unwrap()), "{place} lacks {name}");
        }
        for (name, schema) in schema["properties"].as_object().into_iter().flatten() {
            if let Some(v) = object.get(name) {
                check(schema, v, &format!("{place}.{name}"));
            }
        }
    }
}

#[test]
fn every_message_fits_its_schema() {
    let dir = folder("trace_every_message_fits_its_schema");
    let path = dir.join("t.mcap");
    let record =
        |(i, event)| Record { n: i as u64, t: Time(i as i64 * 1_300_000_000), causes: vec![], event };
    let records: Vec<Record> = sample::every_kind().into_iter().enumerate().map(record).collect();
    write(&path, &records);
    let bytes = fs::read(&path).unwrap();
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!((&*schema.encoding, &*message.channel.message_encoding), ("jsonschema", "json"));
        let schema_json: Json = serde_json::from_slice(&schema.data).unwrap();
        let value: Json = serde_json::from_slice(&message.data).unwrap();
        assert_eq!(schema_json["title"], schema.name);
        check(&schema_json, &value, &message.channel.topic);
        // The schema names every member there is.
        if let (Some(event), Some(known)) =
            (value["event"].as_object(), schema_json["properties"]["event"]["properties"].as_object())
        {
            event.keys().for_each(|k| assert!(known.contains_key(k), "{} has no {k}", schema.name));
            assert_eq!(
                message.channel.topic,
                format!("/soifra/{}", value["event"]["kind"].as_str().unwrap())
            );
        }
        *seen.entry(schema.name.clone()).or_default() += 1;
    }
    assert_eq!(seen.len(), 30 + 3, "{seen:?}");
    assert_eq!(seen["foxglove.FrameTransform"], 2);
    assert_eq!(seen["soifra.SafeAction"], 1);
}

#[test]
fn the_scene_shows_everything_that_has_a_body() {
    let dir = folder("trace_the_scene_shows_everything_that_has_a_body");
    let path = dir.join("t.mcap");
    write(&path, &sample::run(2, 2));
    let bytes = fs::read(&path).unwrap();
    let scene = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .find(|m| m.channel.topic == "/scene")
        .map(|m| serde_json::from_slice::<Json>(&m.data).unwrap())
        .unwrap();
    let ids: Vec<&str> =
        scene["entities"].as_array().unwrap().iter().filter_map(|e| e["id"].as_str()).collect();
    assert_eq!(
        ids,
        [
            "bounds/0", "divider", "pillar", "crate", "dock", "yard", "block[0]", "block[1]", "r1", "r2",
            "r3", "targets"
        ]
    );
    let robot = &scene["entities"][8];
    assert_eq!(robot["frame_id"], "r1/base_link");
    assert_eq!(robot["cylinders"][0]["size"]["x"], 0.008);
}
