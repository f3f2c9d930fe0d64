// A link between two machines of a lab that is as bad as one likes, since not every kernel has netem: a TUN device in
// either namespace, and between them a thread that delays, loses, doubles, damages and slows down packets.
#pragma once

#include "lab.hpp"
#include "line.hpp"

#include <memory>

namespace hive::test {

/// All that goes from the one to the other takes this link, until it is destroyed; other ways stay as they were.
class BadLink {
public:
    BadLink(const Machine& one, const Machine& other, const LineQuality& quality = {}, std::uint64_t seed = 1);
    ~BadLink();
    BadLink(const BadLink&) = delete;
    BadLink& operator=(const BadLink&) = delete;

    /// For the packets that come from now on, both ways.
    void set(const LineQuality& quality);
    /// A black hole: nothing comes through, and nobody is told.
    void swallow() { set({.loss = 1}); }
    /// Of both directions together.
    [[nodiscard]] LineCounts counts() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
