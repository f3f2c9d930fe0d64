#include "run/drawing.hpp"

#include "run/interrupt.hpp"
#include "words/output.hpp"

#include <hive/error.hpp>
#include <hive/platform/descriptor.hpp>
#include <hive/process.hpp>

#include <sys/mman.h>
#include <unistd.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

/// An anonymous file with the text, because dot accepts none on its command line.
hive::platform::Descriptor unnamed(const std::string& text)
{
    hive::platform::Descriptor file(::memfd_create("graph", MFD_CLOEXEC));
    if (!file || ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
        throw hive::Error(hive::Errc::io, "no memory for a graph of " + std::to_string(text.size()) + " bytes");
    return file;
}

}  // namespace

std::string svg_of(const std::string& dot)
{
    const auto file = unnamed(dot);
    const auto path = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file.get());
    const auto drawn = [&] {
        try {
            return hive::run_command({"dot", "-Tsvg", path}, 30s, {}, interrupt::requested);
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
