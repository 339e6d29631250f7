//! Numbers as text that is shorter than their digits: base64 of little-endian bytes.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Bytes, in files as base64.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bytes(pub Vec<u8>);

/// Vectors of `N` numbers, in files as base64 of their bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vectors<const N: usize>(pub Vec<[f64; N]>);

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&STANDARD.encode(&self.0))
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        let bytes = STANDARD.decode(text).map_err(D::Error::custom)?;
        Ok(Self(bytes))
    }
}

impl<const N: usize> Serialize for Vectors<N> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let numbers = self.0.iter().flatten();
        Bytes(numbers.flat_map(|x| x.to_le_bytes()).collect()).serialize(to)
    }
}

impl<'de, const N: usize> Deserialize<'de> for Vectors<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Bytes(bytes) = Bytes::deserialize(from)?;
        let (words, rest) = bytes.as_chunks::<8>();
        let numbers: Vec<f64> = words.iter().map(|w| f64::from_le_bytes(*w)).collect();
        let (vectors, over) = numbers.as_chunks::<N>();
        if !rest.is_empty() || !over.is_empty() {
            let text = format!("{} bytes are no vectors of {N} numbers", bytes.len());
            return Err(D::Error::custom(text));
        }
        Ok(Self(vectors.to_vec()))
    }
}
