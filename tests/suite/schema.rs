//! `schema KIND` is the JSON Schema (draft 2020-12) of what `template KIND` prints: each template,
//! with every option that stands in its comments, is valid, and a slip that the tool refuses is
//! not.

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = SLIPS
        .iter()
        .map(|(kind, slips)| {
            test(&format!("schema: {kind} takes its template and no slip"), move || holds(kind, slips))
        })
        .collect();
    all.push(test("schema: the validator refuses what the draft says it must", validator));
    all
}

/// Kinds, and text that takes the place of other text in their templates.
const SLIPS: &[(&str, &[(&str, &str)])] = &[
    (
        "study",
        &[
            ("bias_deg_h", "bias_deg_hr"),
            ("members = 16384", "members = \"many\""),
            ("duration_s = 60.0", ""),
            ("sd = 12.0", "sigma = 12.0"),
            ("range_g = 8.0", "range_g = -8.0"),
            ("kind = \"sine\"", "kind = \"sinus\""),
            ("frequency_hz = 0.5 ", "from_hz = 0.5 "),
        ],
    ),
    (
        "driven",
        &[("output =", "outputs ="), ("kind = \"driven\"", "kind = \"static\""), ("rate_hz = 6", "rate_hz = \"a\" #")],
    ),
    ("static", &[("channels =", "channel ="), ("channels = [", "channels = [1, ")]),
    (
        "trajectory-study",
        &[
            ("kind = \"car\"", "kind = \"cart\""),
            ("latitude_deg", "latitude"),
            ("lever_arm_m = [0.0, ", "lever_arm_m = ["),
            ("[100.0, 100.0, 150.0]", "[100.0, 150.0]"),
        ],
    ),
    ("tumble", &[("gravity_m_s2", "gravity"), ("[\"gx\", ", "[")]),
    (
        "trajectory",
        &[
            ("[reference]", "[references]"),
            ("[\"gx\", ", "["),
            ("file = \"ground", "path = \"ground"),
            ("kind = \"traj", "kind = \"Traj"),
        ],
    ),
    ("limits", &[("largest_input_m_s2 = 20.0", ""), ("rate_hz = 500.0", "rate_hz = \"500\"")]),
    ("map", &[("cubic_n_m3 = 0.3", ""), ("quantity = \"amplitude_n\"", "quantity = \"amplitude\"")]),
];

fn printed(command: &str, kind: &str) -> Result<String, Failed> {
    let output = program().args([command, kind]).output()?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    Ok(String::from_utf8(output.stdout)?)
}

/// TOML as the JSON that a schema is about.
fn json(text: &str) -> Result<Value, Failed> {
    Ok(serde_json::to_value(toml::from_str::<toml::Value>(text)?)?)
}

/// With the settings that stand in comments.
fn with_options(text: &str) -> String {
    let name = |l: &str| l.split_once(" = ").is_some_and(|(k, _)| k.chars().all(|c| c == '_' || c.is_alphanumeric()));
    let line = |l: &str| match l.strip_prefix("# ") {
        Some(setting) if setting.starts_with('[') || name(setting) => format!("{setting}\n"),
        _ => format!("{l}\n"),
    };
    text.lines().map(line).collect()
}

fn holds(kind: &str, slips: &[(&str, &str)]) -> Result<(), Failed> {
    let schema: Value = serde_json::from_str(&printed("schema", kind)?)?;
    check(schema["$schema"] == "https://json-schema.org/draft/2020-12/schema", schema["$schema"].to_string())?;
    let template = printed("template", kind)?;
    for text in [template.clone(), with_options(&template)] {
        valid(&schema, &schema, &json(&text)?, "").map_err(|e| format!("{e}\n{text}"))?;
    }
    for (right, wrong) in slips {
        let text = template.replacen(right, wrong, 1);
        check(text != template, format!("the template does not hold {right}"))?;
        check(valid(&schema, &schema, &json(&text)?, "").is_err(), format!("{wrong} is valid"))?;
    }
    check(valid(&schema, &schema, &json(&format!("surplus = 1\n{template}"))?, "").is_err(), "a surplus key is valid")
}

/// The keywords that these schemas use; any other is an error, so that none is passed over.
const KEYWORDS: [&str; 22] = [
    "$schema",
    "$defs",
    "$ref",
    "title",
    "description",
    "default",
    "format",
    "type",
    "properties",
    "required",
    "additionalProperties",
    "items",
    "prefixItems",
    "minItems",
    "maxItems",
    "anyOf",
    "oneOf",
    "const",
    "enum",
    "minimum",
    "maximum",
    "exclusiveMinimum",
];

/// Whether a value is as a schema says, by the draft's meaning of each keyword.
fn valid(root: &Value, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
    let fail = |what: String| Err(format!("{at}: {what}"));
    let Some(keys) = schema.as_object() else {
        return if schema == &Value::Bool(true) { Ok(()) } else { fail("nothing may stand here".into()) };
    };
    if let Some(unknown) = keys.keys().find(|k| !KEYWORDS.contains(&k.as_str())) {
        return fail(format!("the validator does not know {unknown}"));
    }
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.trim_start_matches('#')).ok_or(format!("{reference} is not there"))?;
        valid(root, target, value, at)?;
    }
    if let Some(expected) = keys.get("const").filter(|c| *c != value) {
        return fail(format!("need {expected}, got {value}"));
    }
    if keys.get("enum").and_then(Value::as_array).is_some_and(|all| !all.contains(value)) {
        return fail(format!("{value} is none of {}", schema["enum"]));
    }
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        "number" => value.is_number(),
        _ => false,
    };
    let holds = match &schema["type"] {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is),
        _ => true,
    };
    if !holds {
        return fail(format!("{value} is no {}", schema["type"]));
    }
    let number = value.as_f64();
    let limit = |key: &str| schema[key].as_f64();
    if number.zip(limit("minimum")).is_some_and(|(v, least)| v < least)
        || number.zip(limit("maximum")).is_some_and(|(v, most)| v > most)
        || number.zip(limit("exclusiveMinimum")).is_some_and(|(v, below)| v <= below)
    {
        return fail(format!("{value} is out of range"));
    }
    for (key, exactly) in [("anyOf", false), ("oneOf", true)] {
        let Some(all) = schema[key].as_array() else { continue };
        let errors: Vec<String> = all.iter().filter_map(|s| valid(root, s, value, at).err()).collect();
        let fitting = all.len() - errors.len();
        if fitting == 0 || exactly && fitting > 1 {
            return fail(format!("{fitting} of {} alternatives fit: {}", all.len(), errors.join("; ")));
        }
    }
    if let Some(fields) = value.as_object() {
        let missing = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        if let Some(missing) = missing.into_iter().find(|key| !fields.contains_key(*key)) {
            return fail(format!("{missing} is missing"));
        }
        for (key, field) in fields {
            let place = format!("{at}/{key}");
            match (schema["properties"].get(key), keys.get("additionalProperties")) {
                (Some(schema), _) | (None, Some(schema)) => valid(root, schema, field, &place)?,
                (None, None) => {}
            }
        }
    }
    if let Some(items) = value.as_array() {
        let count = items.len() as u64;
        if schema["minItems"].as_u64().is_some_and(|least| count < least)
            || schema["maxItems"].as_u64().is_some_and(|most| count > most)
        {
            return fail(format!("{count} items"));
        }
        for (k, item) in items.iter().enumerate() {
            let first = schema["prefixItems"].get(k);
            if let Some(schema) = first.or(keys.get("items")) {
                valid(root, schema, item, &format!("{at}/{k}"))?;
            }
        }
    }
    Ok(())
}

fn validator() -> Result<(), Failed> {
    let schema = serde_json::json!({
        "type": "object", "required": ["a"], "additionalProperties": false,
        "properties": {
            "a": { "anyOf": [{ "type": "number", "minimum": 0 }, { "$ref": "#/$defs/pair" }] },
            "b": { "enum": ["x", "y"] },
        },
        "$defs": { "pair": { "type": "array", "items": { "type": "integer" }, "minItems": 2, "maxItems": 2 } },
    });
    let answer = |text: &str| -> Result<bool, Failed> {
        let value = serde_json::from_str(text)?;
        Ok(valid(&schema, &schema, &value, "").is_ok())
    };
    for good in [r#"{"a": 0}"#, r#"{"a": [1, 2], "b": "x"}"#] {
        check(answer(good)?, format!("{good} is not valid"))?;
    }
    for bad in [
        r#"{}"#,
        r#"{"a": -1}"#,
        r#"{"a": [1]}"#,
        r#"{"a": [1, 2.5]}"#,
        r#"{"a": 1, "c": 1}"#,
        r#"{"a": 1, "b": "z"}"#,
        "1",
    ] {
        check(!answer(bad)?, format!("{bad} is valid"))?;
    }
    let unknown = serde_json::json!({ "pattern": "x" });
    check(valid(&unknown, &unknown, &Value::Null, "").is_err(), "a keyword that is not known passes")
}
