// Numbers of the wire: unsigned, little endian.
#pragma once

#include <cstddef>

namespace hive::protocol {

template <class Number>
void store(unsigned char* at, Number value) noexcept
{
    for (std::size_t i = 0; i < sizeof value; ++i)
        at[i] = static_cast<unsigned char>(value >> (8 * i));
}

template <class Number>
Number load(const unsigned char* at) noexcept
{
    Number value = 0;
    for (std::size_t i = 0; i < sizeof value; ++i)
        value = static_cast<Number>(value | static_cast<Number>(at[i]) << (8 * i));
    return value;
}

}  // namespace hive::protocol
