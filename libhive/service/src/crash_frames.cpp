// Walks the stack, and parses the descriptions of its frames.
#include "crash_frames.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <cxxabi.h>
#include <dlfcn.h>
#include <sys/auxv.h>
#include <unwind.h>

namespace hive::service {
namespace {

/// Rates how likely a frame is the cause; higher is likelier.
enum Rank { runtime, entry, library, own };

template <std::size_t size>
void copy(char (&to)[size], std::string_view from)
{
    const auto length = from.copy(to, size - 1);
    to[length] = '\0';
}

std::string_view base_name(std::string_view path) { return path.substr(path.rfind('/') + 1); }

/// "hive-face+0x1a2b"; empty: not in a file.
void name_by_place(char (&function)[512], void* address)
{
    Dl_info info{};
    function[0] = '\0';
    if (::dladdr(address, &info) != 0 && info.dli_fname)
        std::snprintf(function, sizeof function, "%s+0x%zx", base_name(info.dli_fname).data(),
                      static_cast<std::size_t>(static_cast<char*>(address) - static_cast<char*>(info.dli_fbase)));
}

/// "std::sort" of "void std::sort<...>(...)".
std::string_view bare_name(std::string_view function)
{
    const auto bare = function.substr(0, function.find_first_of("<("));
    return bare.substr(bare.rfind(' ') + 1);
}

Rank rank_of(void* address, std::string_view function)
{
    Dl_info program{}, place{};
    if (::dladdr(address, &place) == 0 || ::dladdr(reinterpret_cast<void*>(::getauxval(AT_ENTRY)), &program) == 0)
        return runtime;
    if (place.dli_fbase != program.dli_fbase)
        return base_name(place.dli_fname).starts_with("libhive") ? library : runtime;
    const auto name = bare_name(function);
    return name == "main" || name == "_start" || name.starts_with("std::") || name.starts_with("__") ? entry : own;
}

_Unwind_Reason_Code add(_Unwind_Context* context, void* to)
{
    auto& frames = *static_cast<Frames*>(to);
    int interrupted = 0;
    void* const address = reinterpret_cast<void*>(_Unwind_GetIPInfo(context, &interrupted));
    if (interrupted != 0)
        frames.count = 0;                                                // the frames so far belong to the handler
    if (frames.count == Frames::most || (!address && interrupted == 0))  // null follows the outermost frame
        return _URC_NORMAL_STOP;
    frames.exact[frames.count] = interrupted != 0;
    frames.addresses[frames.count++] = address;
#ifdef __x86_64__
    // A call through a null pointer has no frame, but its return address is on the stack.
    if (Dl_info none; interrupted != 0 && ::dladdr(address, &none) == 0)
        frames.addresses[frames.count++] = *reinterpret_cast<void**>(_Unwind_GetCFA(context));
#endif
    return _URC_NO_REASON;
}

}  // namespace

void Frames::walk()
{
    count = 0;
    _Unwind_Backtrace(add, this);
}

void* Frames::shown(int index) const { return static_cast<char*>(addresses[index]) - (exact[index] ? 0 : 1); }

bool Explained::next()
{
    if (*rest_ == '\0')
        return false;
    char* const end = std::strchr(rest_, '\n');
    std::string_view line(rest_, end ? static_cast<std::size_t>(end - rest_) : std::strlen(rest_));
    rest_ += line.size() + (end ? 1 : 0);
    constexpr std::string_view inlined = " (inlined by) ", between = " at ";
    if (line.starts_with(inlined))
        line.remove_prefix(inlined.size());
    else if (++index_ == frames_.count)
        return false;
    const auto at = line.rfind(between);
    const auto source = at == std::string_view::npos ? std::string_view() : line.substr(at + between.size());
    copy(frame_.function, line.substr(0, at));
    copy(frame_.source, source.starts_with("??") ? "" : source);
    if (line.starts_with("??"))
        name_by_place(frame_.function, frames_.shown(index_));
    if (const int rank = rank_of(frames_.shown(index_), frame_.function); rank > rank_) {
        rank_ = rank;
        cause_ = frame_;
    }
    return true;
}

Frame exported_cause(const Frames& frames)
{
    int best = -1;
    void* address = nullptr;
    for (int i = 0; i < frames.count; ++i)
        if (const int rank = rank_of(frames.shown(i), ""); rank > best) {
            best = rank;
            address = frames.shown(i);
        }
    Frame cause;
    name_by_place(cause.function, address);
    if (Dl_info info{}; ::dladdr(address, &info) != 0 && info.dli_sname) {
        char* const name = abi::__cxa_demangle(info.dli_sname, nullptr, nullptr, nullptr);
        copy(cause.function, name ? name : info.dli_sname);
        std::free(name);
    }
    return cause;
}

Frame foreign_cause(const char* text)
{
    Frame cause;
    const char* line = std::strstr(text, "Current thread ");
    for (line = line ? std::strchr(line, '\n') : nullptr; line; line = std::strchr(line, '\n')) {
        Frame frame;
        int number = 0, read = 0;
        if (std::sscanf(++line, "  File \"%500[^\"]\", line %d in %n%511[^\n]", frame.source, &number, &read,
                        frame.function)
            != 3)
            break;
        const auto length = std::strlen(frame.source);
        std::snprintf(frame.source + length, sizeof frame.source - length, ":%d", number);
        const bool own = !std::strstr(frame.source, "/lib/python");
        if (own || *cause.function == '\0')
            cause = frame;
        if (own)
            break;
    }
    return cause;
}

}  // namespace hive::service
