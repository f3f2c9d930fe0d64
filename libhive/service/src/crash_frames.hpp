// The frames of a crash, and which of them is its cause. Nothing here allocates, except where it is said.
#pragma once

namespace hive::service {

/// A function, and where it stands; each may be unknown, and is empty then.
struct Frame {
    char function[512] = "";
    char source[512] = "";  ///< "/src/main.cpp:12:5"
};

/// Addresses of code, the innermost first.
struct Frames {
    static constexpr int most = 64;

    /// Of the calling thread, from the one that the outermost signal handler has interrupted.
    void walk();
    /// An address within the call: what walk() finds are the addresses to which the calls return.
    [[nodiscard]] void* shown(int index) const;

    void* addresses[most]{};
    bool exact[most]{};  ///< the address of the instruction itself
    int count = 0;
};

/// Reads what `eu-addr2line -fCi --pretty-print` says of frames: a line for each, and one for each that is inlined.
class Explained {
public:
    Explained(const Frames& frames, char* text) : frames_(frames), rest_(text) {}
    /// @return false behind the last one
    bool next();
    [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
    /// The innermost frame of the program's own so far, else of libhive, else of all.
    [[nodiscard]] const Frame& cause() const noexcept { return cause_; }

private:
    const Frames& frames_;
    char* rest_;
    int index_ = -1;
    int rank_ = -1;
    Frame frame_, cause_;
};

/// The same cause by the symbols that are exported. It allocates.
Frame exported_cause(const Frames& frames);
/// The first frame of the thread that crashed which is no library's, in what Python's faulthandler has written.
Frame foreign_cause(const char* text);

}  // namespace hive::service
