// A header that Mitsuba includes and its wheel lacks: what the declaration of Bitmap needs. The plugin never uses it.
#pragma once
#include <cstdint>
namespace struct_jit {
enum class Type : uint32_t {
    UInt8, Int8, UInt16, Int16, UInt32, Int32, UInt64, Int64, Float16, Float32, Float64, Invalid
};
template <typename T> struct type_id { static constexpr Type value = Type::Invalid; };
template <typename T> constexpr Type type_v = type_id<T>::value;
class Struct {};
}
