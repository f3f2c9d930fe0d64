// Records which coefficients the scans of a JPEG contain: to the decoder, an image cut between two scans looks
// complete.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace hive::vision {

/// T.81, B.2.3 and G.1.1.1: a scan contains the coefficients first to last of its components, down to the bit `low`.
class ScanCoverage {
public:
    /// Adds the parameters of one scan; false if they are invalid.
    bool add(std::span<const std::uint8_t> header, bool progressive) noexcept
    {
        const std::size_t components = header.empty() ? 0 : header[0];
        if (components < 1 || components > 4 || header.size() != 4 + 2 * components)
            return false;
        const unsigned first = progressive ? header[1 + 2 * components] : 0,
                       last = progressive ? header[2 + 2 * components] : 63;
        const unsigned low = progressive ? header[3 + 2 * components] & 15U : 0;
        if (first > last || last > 63)
            return false;
        for (std::size_t i = 0; i < components; ++i)
            for (unsigned coefficient = first; coefficient <= last; ++coefficient)
                missing_bits_[header[1 + 2 * i]][coefficient] = static_cast<std::uint8_t>(low);
        return true;
    }

    /// Are all 64 coefficients of the component with this identifier present, to the last bit?
    [[nodiscard]] bool complete(std::uint8_t component) const noexcept
    {
        for (const std::uint8_t missing : missing_bits_[component])
            if (missing != 0)
                return false;
        return true;
    }

    ScanCoverage() noexcept
    {
        for (auto& component : missing_bits_)
            component.fill(none);
    }

private:
    static constexpr std::uint8_t none = 16;  ///< no bit of the coefficient is present
    std::array<std::array<std::uint8_t, 64>, 256> missing_bits_;
};

}  // namespace hive::vision
