// A configurable bad link between two machines of a lab, because not every kernel has netem: a TUN device in each
// namespace, and between them a thread that delays, loses, duplicates, damages and slows down packets.
#pragma once

#include "lab.hpp"
#include "line.hpp"

#include <memory>

namespace hive::test {

/// All traffic between the two uses this link until it is destroyed; other routes are unchanged.
class BadLink {
public:
    BadLink(const Machine& one, const Machine& other, const LineQuality& quality = {}, std::uint64_t seed = 1);
    ~BadLink();
    BadLink(const BadLink&) = delete;
    BadLink& operator=(const BadLink&) = delete;

    /// For later packets, in both directions.
    void set(const LineQuality& quality);
    /// A black hole: drops everything silently.
    void swallow() { set({.loss = 1}); }
    /// Of both directions together.
    [[nodiscard]] LineCounts counts() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
