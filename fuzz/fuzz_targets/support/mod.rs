//! What the targets of the C functions share: numbers of all kinds, and memory as a C program might pass it.
//!
//! Arrays are exactly as long as the header asks for, so that the address sanitizer sees every step beyond them.

// Each target uses a part of it.
#![allow(dead_code)]

use arbitrary::{Arbitrary, Result, Unstructured};

/// The bytes of the input, as numbers.
pub struct Source<'a>(pub Unstructured<'a>);

impl Source<'_> {
    pub fn any<T: for<'b> Arbitrary<'b>>(&mut self) -> Result<T> {
        T::arbitrary(&mut self.0)
    }

    /// True once in `one_in` times, and when the bytes have run out never.
    pub fn rarely(&mut self, one_in: u8) -> Result<bool> {
        Ok(self.any::<u8>()? % one_in == one_in - 1)
    }

    /// At most `most`; now and then any number.
    pub fn small(&mut self, most: u32) -> Result<u32> {
        if self.rarely(64)? { self.any() } else { Ok(u32::from(self.any::<u16>()?) % (most + 1)) }
    }

    /// A plain number; now and then any pattern of bits.
    pub fn number(&mut self) -> Result<f32> {
        match self.any::<u8>()? {
            0..16 => Ok(0.0),
            16..248 => Ok(f32::from(self.any::<i16>()?) / 4096.0),
            _ => self.any(),
        }
    }

    /// In [0, 1]; now and then any pattern of bits.
    pub fn unit(&mut self) -> Result<f32> {
        if self.rarely(255)? { self.any() } else { Ok(f32::from(self.any::<u16>()?) / 65535.0) }
    }

    /// An array, of which the C function may be told a wrong address: NULL, or one that is not aligned.
    pub fn array<T>(&mut self, len: usize, mut element: impl FnMut(&mut Self) -> Result<T>) -> Result<Array<T>> {
        let values = (0..len).map(|_| element(self)).collect::<Result<Vec<T>>>()?;
        let address = match self.any::<u8>()? {
            254 => Address::Odd,
            255 => Address::Null,
            _ => Address::Good,
        };
        Ok(Array { values, address })
    }

    /// Memory for `bytes` bytes; now and then less of it.
    pub fn memory(&mut self, bytes: usize) -> Result<Array<u64>> {
        let words = bytes.div_ceil(8);
        let words = if self.rarely(32)? { words / 2 } else { words };
        self.array(words, |_| Ok(0xA5A5_A5A5_A5A5_A5A5))
    }
}

enum Address {
    Good,
    Odd,
    Null,
}

pub struct Array<T> {
    pub values: Vec<T>,
    address: Address,
}

impl<T> Array<T> {
    pub fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }

    pub fn pointer(&self) -> *const T {
        match self.address {
            Address::Good => self.values.as_ptr(),
            Address::Odd => self.values.as_ptr().wrapping_byte_add(1),
            Address::Null => std::ptr::null(),
        }
    }

    pub fn pointer_mut(&mut self) -> *mut T {
        match self.address {
            Address::Good => self.values.as_mut_ptr(),
            Address::Odd => self.values.as_mut_ptr().wrapping_byte_add(1),
            Address::Null => std::ptr::null_mut(),
        }
    }
}
