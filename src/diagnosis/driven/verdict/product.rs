//! Products of units, brought to lowest terms: `um/((m/s^2) s^2)` is `um/m`.

/// A unit and its power.
type Factor = (String, i32);

/// The same unit with each factor once; `None` where it is no plain product of powers, as √s is none.
pub(super) fn reduced(unit: &str) -> Option<String> {
    let letters: Vec<char> = unit.chars().collect();
    let mut at = 0;
    let mut factors = Vec::new();
    product(&letters, &mut at, 1, &mut factors)?;
    (at == letters.len()).then(|| written(&factors))
}

/// Reads factors up to the end or a closing bracket; `sign` is that of the whole.
fn product(letters: &[char], at: &mut usize, sign: i32, factors: &mut Vec<Factor>) -> Option<()> {
    let mut next = sign;
    while let Some(letter) = letters.get(*at) {
        match letter {
            ')' => return Some(()),
            ' ' => *at += 1,
            '/' => {
                next = -sign;
                *at += 1;
            }
            '(' => {
                *at += 1;
                let mut inner = Vec::new();
                product(letters, at, 1, &mut inner)?;
                (letters.get(*at) == Some(&')')).then_some(())?;
                *at += 1;
                let power = next * power(letters, at)?;
                inner.into_iter().for_each(|(name, own)| add(factors, name, own * power));
                next = sign;
            }
            _ => {
                let from = *at;
                while letters.get(*at).is_some_and(|c| !" /()^".contains(*c)) {
                    *at += 1;
                }
                let name: String = letters[from..*at].iter().collect();
                // A root, or a bracket right behind a name.
                if name.is_empty() || letters.get(*at) == Some(&'(') {
                    return None;
                }
                let power = next * power(letters, at)?;
                if name != "1" {
                    add(factors, name, power);
                }
                next = sign;
            }
        }
    }
    Some(())
}

/// The whole number behind `^`, else 1.
fn power(letters: &[char], at: &mut usize) -> Option<i32> {
    if letters.get(*at) != Some(&'^') {
        return Some(1);
    }
    *at += 1;
    let from = *at;
    while letters.get(*at).is_some_and(|c| c.is_ascii_digit() || (*c == '-' && *at == from)) {
        *at += 1;
    }
    letters[from..*at].iter().collect::<String>().parse().ok()
}

fn add(factors: &mut Vec<Factor>, name: String, power: i32) {
    match factors.iter_mut().find(|(known, _)| *known == name) {
        Some((_, known)) => *known += power,
        None => factors.push((name, power)),
    }
}

fn written(factors: &[Factor]) -> String {
    let side = |sign: i32| -> Vec<String> {
        let of = factors.iter().filter(|(_, power)| power * sign > 0);
        of.map(|(name, power)| if power.abs() == 1 { name.clone() } else { format!("{name}^{}", power.abs()) })
            .collect()
    };
    let (above, below) = (side(1), side(-1));
    let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    match &below[..] {
        [] => above,
        [only] => format!("{above}/{only}"),
        several => format!("{above}/({})", several.join(" ")),
    }
}

#[cfg(test)]
mod tests {
    use super::reduced;

    #[test]
    fn products_are_brought_to_lowest_terms() {
        for (given, expected) in [
            ("(m)/((m/s^2) s^2)", Some("1")),
            ("(um)/((m/s^2) s^2)", Some("um/m")),
            ("(um)/((g) s^2)", Some("um/(g s^2)")),
            ("1/((m/s^2)^2 s^2)", Some("s^2/m^2")),
            ("(m/s^2)/s^2", Some("m/s^4")),
            ("rad/s", Some("rad/s")),
            ("(V)/sqrt(s)", None),
            ("(m", None),
        ] {
            assert_eq!(reduced(given).as_deref(), expected, "{given}");
        }
    }
}
