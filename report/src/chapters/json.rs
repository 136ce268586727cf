//! How a chapter's JSON is written: small, and a row of a table to a line, so that a difference is readable.

use itertools::Itertools;
use serde_json::Value;

/// Significant digits of a number.
const DIGITS: usize = 6;

/// The text of a chapter's file.
pub(crate) fn written(value: &Value) -> String {
    write(value, 0) + "\n"
}

fn write(value: &Value, depth: usize) -> String {
    let is_list =
        value.as_array().is_some_and(|values| values.iter().any(|value| value.is_array() || value.is_object()));
    let separator = if depth < 2 || (is_list && depth < 4) { ",\n" } else { "," };
    match value {
        Value::Array(values) => format!("[{}]", values.iter().map(|value| write(value, depth + 1)).join(separator)),
        Value::Object(fields) => {
            let field = |(name, value)| format!("{}:{}", Value::from(name), write(value, depth + 1));
            format!("{{{}}}", fields.iter().map(|(name, value)| (name.as_str(), value)).map(field).join(separator))
        }
        Value::Number(number) if number.is_f64() => {
            let short = format!("{:.*e}", DIGITS - 1, number.as_f64().unwrap_or(0.0));
            short.parse::<f64>().map_or(Value::Null, Value::from).to_string()
        }
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::{DIGITS, written};
    use serde_json::{Value, json};

    #[test]
    fn only_the_last_digits_of_numbers_are_lost() {
        let text = written(&json!({"tables": [{"rows": [["a, b", {"value": 0.123456789, "seeds": 8}], [null, -3]]}]}));
        assert_eq!(text, "{\"tables\":[{\"rows\":[[\"a, b\",{\"seeds\":8,\"value\":0.123457}],\n[null,-3]]}]}\n");
        let large = json!([1e300, 123456789012.0, 2.0, 1e-5]);
        let back: Value = serde_json::from_str(&written(&large)).expect("it is JSON");
        for (a, b) in large.as_array().unwrap().iter().zip(back.as_array().unwrap()) {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a / b - 1.0).abs() < 10f64.powi(1 - DIGITS as i32));
        }
    }
}
