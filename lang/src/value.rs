//! Values as the command line writes them: `3m`, `off`, `published`, `1.5`.

use soifra_graph::{QuantityUnit, Type, TypeTable, Value, did_you_mean};

/// Reads `text` as a value of type `ty`. The error is a sentence for the user.
pub fn parse_value(text: &str, ty: &Type, types: &TypeTable) -> Result<Value, String> {
    let text = text.trim();
    match ty {
        Type::Bool => match text {
            "true" | "on" | "yes" => Ok(Value::Bool(true)),
            "false" | "off" | "no" => Ok(Value::Bool(false)),
            _ => Err(format!("`{text}` is neither on nor off")),
        },
        Type::Int => text
            .parse::<i64>()
            .ok()
            .filter(|i| i.abs() <= 1 << 53)
            .map(Value::Int)
            .ok_or_else(|| format!("`{text}` is no whole number")),
        Type::Quantity(dim) | Type::Distribution(dim) => {
            let split = text.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E') || c == '%');
            // `1e3` is a number, `1 east` none: an exponent is followed by a digit or sign.
            let split = split.or_else(|| {
                text.char_indices()
                    .find(|(i, c)| {
                        matches!(c, 'e' | 'E')
                            && !text[i + 1..]
                                .starts_with(|n: char| n.is_ascii_digit() || n == '-' || n == '+')
                    })
                    .map(|(i, _)| i)
            });
            let (number, unit) = text.split_at(split.unwrap_or(text.len()));
            let unit = unit.trim();
            let parsed = QuantityUnit::parse(if unit.is_empty() { "1" } else { unit })
                .map_err(|part| format!("`{part}` is no unit"))?;
            let (sign, digits) = match number.trim().strip_prefix('-') {
                Some(d) => (-1.0, d),
                None => (1.0, number.trim()),
            };
            let v = digits
                .starts_with(|c: char| c.is_ascii_digit())
                .then(|| parsed.value(digits))
                .flatten()
                .ok_or_else(|| format!("`{text}` is no finite number"))?;
            if parsed.dim != *dim {
                let want = dim.si_unit();
                return Err(if unit.is_empty() {
                    format!("`{text}` needs a unit, for example `{text} {want}`")
                } else {
                    format!("`{text}` is {}, {ty} is wanted", parsed.dim)
                });
            }
            Ok(match ty {
                Type::Distribution(_) => Value::Distribution(soifra_graph::Distribution::Exact(sign * v)),
                _ => Value::Number(sign * v),
            })
        }
        Type::Heading(_) => parse_value(text, &Type::Quantity(soifra_graph::Dim::ANGLE), types),
        Type::Text => Ok(Value::Text(text.trim_matches('"').to_string())),
        Type::Enum(name) => {
            let variants = types.enums.get(name).map(|e| e.variants.as_slice()).unwrap_or_default();
            match variants.iter().find(|v| ***v == *text) {
                Some(v) => Ok(Value::Variant(v.clone())),
                None => Err(match did_you_mean(text, variants.iter().map(|v| &**v)) {
                    Some(near) => format!("`{text}` is no choice here; did you mean `{near}`?"),
                    None => format!(
                        "`{text}` is no choice here; possible are {}",
                        variants.iter().map(|v| &**v).collect::<Vec<_>>().join(", ")
                    ),
                }),
            }
        }
        Type::Option(inner) => match text {
            "none" => Ok(Value::None("not given".into())),
            _ => Ok(Value::Some(Box::new(parse_value(text, inner, types)?))),
        },
        Type::Point(_) | Type::Vector(..) => {
            let inner = text.trim_start_matches('(').trim_end_matches(')');
            let dim = if let Type::Vector(_, d) = ty { *d } else { soifra_graph::Dim::LENGTH };
            let parts: Vec<&str> = inner.split(',').collect();
            if !(2..=3).contains(&parts.len()) {
                return Err(format!("`{text}` is no point; write (x, y)"));
            }
            let mut v = [0.0; 3];
            for (slot, part) in v.iter_mut().zip(parts) {
                *slot = parse_value(part, &Type::Quantity(dim), types)?.number().unwrap_or(0.0);
            }
            Ok(Value::Vector(v))
        }
        _ => Err(format!("a parameter of type {ty} cannot be set from the command line")),
    }
}
