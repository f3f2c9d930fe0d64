// The stack frames of a crash, and which of them is its cause. Nothing here allocates unless noted.
#pragma once

namespace hive::service {

/// A function and its source position; each is empty if unknown.
struct Frame {
    char function[512] = "";
    char source[512] = "";  ///< "/src/main.cpp:12:5"
};

/// Addresses of code, the innermost first.
struct Frames {
    static constexpr int most = 64;

    /// Walks the stack of the calling thread, from the frame that the outermost signal handler interrupted.
    void walk();
    /// An address within the call instruction, since walk() finds return addresses.
    [[nodiscard]] void* shown(int index) const;

    void* addresses[most]{};
    bool exact[most]{};  ///< the address of the instruction itself
    int count = 0;
};

/// Parses the output of `eu-addr2line -fCi --pretty-print`: a line for each frame and each inlined function.
class Explained {
public:
    Explained(const Frames& frames, char* text) : frames_(frames), rest_(text) {}
    /// @return false after the last one
    bool next();
    [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
    /// The innermost frame so far of the program itself, else of libhive, else of all.
    [[nodiscard]] const Frame& cause() const noexcept { return cause_; }

private:
    const Frames& frames_;
    char* rest_;
    int index_ = -1;
    int rank_ = -1;
    Frame frame_, cause_;
};

/// The same cause by exported symbols. Allocates.
Frame exported_cause(const Frames& frames);
/// The first frame of the crashed thread outside of libraries, in the output of Python's faulthandler.
Frame foreign_cause(const char* text);

}  // namespace hive::service
