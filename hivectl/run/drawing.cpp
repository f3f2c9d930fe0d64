#include "run/drawing.hpp"

#include "run/interrupt.hpp"
#include "words/output.hpp"

#include <hive/error.hpp>
#include <hive/process.hpp>

#include <sys/mman.h>
#include <unistd.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

/// Puts a text into an anonymous file, because dot accepts none on its command line.
class Unnamed {
public:
    explicit Unnamed(const std::string& text) : descriptor_(::memfd_create("graph", MFD_CLOEXEC))
    {
        if (descriptor_ < 0 || ::write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
            throw hive::Error(hive::Errc::io, "no memory for a graph of " + std::to_string(text.size()) + " bytes");
    }
    ~Unnamed() { ::close(descriptor_); }
    Unnamed(const Unnamed&) = delete;
    Unnamed& operator=(const Unnamed&) = delete;
    [[nodiscard]] std::string path() const
    {
        return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(descriptor_);
    }

private:
    int descriptor_;
};

}  // namespace

std::string svg_of(const std::string& dot)
{
    const Unnamed file(dot);
    const auto drawn = [&] {
        try {
            return hive::run_command({"dot", "-Tsvg", file.path()}, 30s, {}, interrupt::requested);
        } catch (const hive::Error& error) {
            throw hive::Error(hive::Errc::not_found, "dot cannot be run: " + std::string(error.what()),
                              "install Graphviz (apt install graphviz)");
        }
    }();
    if (drawn.late)
        throw hive::Error(hive::Errc::timeout, "dot has not drawn the graph within 30 s",
                          "draw it yourself: hivectl graph --as dot > swarm.dot");
    if (drawn.exit_code != 0)
        throw hive::Error(hive::Errc::failed, "dot failed: " + printable(drawn.err),
                          "see what it read: hivectl graph --as dot");
    return drawn.out;
}

}  // namespace hivectl
