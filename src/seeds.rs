//! Lists of seeds: `20` (1 to 20), `5..9`, `1..20,42`; and shards of a sweep: `2/4`.

/// Most seeds one sweep may have.
const LIMIT: usize = 1_000_000;

/// Parses a list of seeds. A single number N stands for 1 to N; ranges include both ends.
pub fn parse(text: &str) -> Result<Vec<u64>, String> {
    if let Ok(n) = text.trim().parse::<u64>() {
        if n == 0 {
            return Err("0 seeds are none: give at least 1".into());
        }
        return range(1, n);
    }
    let mut out = Vec::new();
    for part in text.split(',') {
        let part = part.trim();
        match part.split_once("..") {
            Some((a, b)) => out.extend(range(number(a)?, number(b.trim_start_matches('='))?)?),
            None => out.push(number(part)?),
        }
        if out.len() > LIMIT {
            return Err(format!("more than {LIMIT} seeds"));
        }
    }
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

fn number(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("`{}` is no seed: seeds are whole numbers from 0", text.trim()))
}

fn range(a: u64, b: u64) -> Result<Vec<u64>, String> {
    if a > b {
        return Err(format!("{a}..{b} runs backwards"));
    }
    if b - a >= LIMIT as u64 {
        return Err(format!("more than {LIMIT} seeds"));
    }
    Ok((a..=b).collect())
}

/// Parses a shard `i/n`, counted from 1.
pub fn shard(text: &str) -> Result<(usize, usize), String> {
    let parts =
        text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    match parts {
        Some((i, n)) if (1..=n).contains(&i) => Ok((i, n)),
        _ => Err(format!("`{text}` is no shard: give i/n with i from 1 to n, as 2/4")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_shards() {
        assert_eq!(parse("3"), Ok(vec![1, 2, 3]));
        assert_eq!(parse("5..7, 2,6"), Ok(vec![2, 5, 6, 7]));
        assert!(
            parse("0").is_err()
                && parse("7..5").is_err()
                && parse("x").is_err()
                && parse("0..99999999999").is_err()
        );
        assert_eq!(shard("2/4"), Ok((2, 4)));
        assert!(shard("0/4").is_err() && shard("5/4").is_err() && shard("2").is_err());
    }
}
