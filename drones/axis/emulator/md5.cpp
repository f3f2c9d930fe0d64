// Computes four rounds of sixteen steps over blocks of 64 bytes.
#include "md5.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace axis::emulator {
namespace {

using State = std::array<std::uint32_t, 4>;

std::array<std::uint32_t, 64> sines()
{
    std::array<std::uint32_t, 64> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] =
            static_cast<std::uint32_t>(std::floor(std::abs(std::sin(static_cast<double>(i + 1))) * 4294967296.0));
    return table;
}

std::uint32_t word(std::string_view block, std::size_t index)
{
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | static_cast<unsigned char>(block[4 * index + i]);
    return value;
}

void digest_block(State& state, std::string_view block)
{
    static const auto table = sines();
    constexpr int turns[4][4]{{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
    auto [a, b, c, d] = state;
    for (std::size_t i = 0; i < 64; ++i) {
        const std::size_t round = i / 16;
        const std::uint32_t mixed[4]{(b & c) | (~b & d), (b & d) | (c & ~d), b ^ c ^ d, c ^ (b | ~d)};
        const std::size_t order[4]{i, (5 * i + 1) % 16, (3 * i + 5) % 16, (7 * i) % 16};
        const std::uint32_t sum = a + mixed[round] + table[i] + word(block, order[round]);
        a = d;
        d = c;
        c = b;
        b += std::rotl(sum, turns[round][i % 4]);
    }
    state = {state[0] + a, state[1] + b, state[2] + c, state[3] + d};
}

}  // namespace

std::string md5(std::string_view text)
{
    std::string padded(text);
    padded += '\x80';
    padded.append((120 - padded.size() % 64) % 64, '\0');
    for (int i = 0; i < 8; ++i)
        padded += static_cast<char>(text.size() * 8 >> (8 * i));
    State state{0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476};
    for (std::size_t at = 0; at < padded.size(); at += 64)
        digest_block(state, std::string_view(padded).substr(at, 64));
    std::string result;
    for (const std::uint32_t part : state)
        for (int i = 0; i < 8; ++i)
            result += "0123456789abcdef"[part >> (8 * (i / 2) + (i % 2 ? 0 : 4)) & 15];
    return result;
}

}  // namespace axis::emulator
