// The functions of outputs.
#include "drone_object.hpp"
#include "texts.hpp"

using namespace hive;
using namespace hive::c;

namespace {

constexpr std::size_t max_loan = 64 << 20;  ///< the body of an event (SPEC.md, section 3)

/// An output, and the reference that keeps it alive during the call.
struct OpenOutput {
    std::shared_ptr<OutputObject> object;
    std::shared_ptr<EmbeddedDrone> drone;

    const Output* operator->() const { return &object->output; }
};

/// From any thread.
OpenOutput opened(const hive_output* handle)
{
    auto object = get<OutputObject>(handle);
    auto drone = object->drone->open();
    return {std::move(object), std::move(drone)};
}

OpenOutput for_user_thread(const hive_output* handle)
{
    auto object = get<OutputObject>(handle);
    auto drone = object->drone->on_user_thread();
    return {std::move(object), std::move(drone)};
}

Body body_of(const hive_body* body) { return body ? get<BodyObject>(body)->body : Body(); }

/// A body that the caller's code creates on demand; we then own its reference.
std::function<Body()> made_by(hive_body_callback make, void* user)
{
    required(make, "what makes the body");
    return [make, user] {
        hive_body* made = nullptr;
        forget_error();
        require_done(make(user, &made));
        const Body body = get<BodyObject>(required(made, "the body"))->body;
        hive_release(made);
        return body;
    };
}

std::chrono::system_clock::time_point time_of(int64_t captured_us)
{
    return std::chrono::system_clock::time_point(std::chrono::microseconds(captured_us));
}

}  // namespace

hive_code hive_output_wanted(const hive_output* output, bool* wanted)
{
    return guarded([&] { *required(wanted, "the place for the answer") = for_user_thread(output)->wanted(); });
}

hive_code hive_output_received(const hive_output* output, bool* received)
{
    return guarded([&] { *required(received, "the place for the answer") = for_user_thread(output)->received(); });
}

hive_code hive_output_asked(const hive_output* output, bool* asked)
{
    return guarded([&] { *required(asked, "the place for the answer") = for_user_thread(output)->asked(); });
}

hive_code hive_output_loan(const hive_output* output, size_t size, hive_loan** loan)
{
    return guarded([&] {
        required(loan, "the place for the loan");
        require_at_most("a loan", size, max_loan, "emit less at once");
        *loan = give(std::make_shared<LoanObject>(opened(output)->loan(size)));
    });
}

hive_code hive_output_emit(hive_output* output, const char* header, size_t length, const void* bytes, size_t size,
                           const char* type)
{
    return guarded([&] {
        const auto open = for_user_thread(output);
        const auto* first = static_cast<const unsigned char*>(size > 0 ? required(bytes, "the bytes") : bytes);
        open->emit(header_of(header, length), Body(std::vector<unsigned char>(first, first + size)),
                   text_or_empty(type));
    });
}

hive_code hive_output_emit_body(hive_output* output, const char* header, size_t length, const hive_body* body,
                                const char* type)
{
    return guarded([&] {
        const auto open = for_user_thread(output);
        if (body)
            open->emit(header_of(header, length), body_of(body), text_or_empty(type));
        else
            open->emit(
                header_of(header, length), [] { return Body(); }, text_or_empty(type));
    });
}

hive_code hive_output_emit_made(hive_output* output, const char* header, size_t length, hive_body_callback make,
                                void* user, const char* type)
{
    return guarded(
        [&] { for_user_thread(output)->emit(header_of(header, length), made_by(make, user), text_or_empty(type)); });
}

hive_code hive_output_emit_captured(hive_output* output, int64_t captured_us, bool lossless, const char* header,
                                    size_t length, const hive_body* body, const char* type)
{
    return guarded([&] {
        const Body bytes = body_of(body);
        for_user_thread(output)->emit_captured(
            time_of(captured_us), lossless, header_of(header, length), [&] { return bytes; }, text_or_empty(type));
    });
}

hive_code hive_output_emit_captured_made(hive_output* output, int64_t captured_us, bool lossless, const char* header,
                                         size_t length, hive_body_callback make, void* user, const char* type)
{
    return guarded([&] {
        for_user_thread(output)->emit_captured(time_of(captured_us), lossless, header_of(header, length),
                                               made_by(make, user), text_or_empty(type));
    });
}

hive_code hive_output_fail(hive_output* output, int64_t captured_us, bool lossless, hive_code code, const char* text)
{
    return guarded([&] {
        const auto open = for_user_thread(output);
        try {
            open->fail(time_of(captured_us), lossless, errc_of(code), text_or_empty(text));
        } catch (const Error&) {
            open.object->drone->keep_failure(std::current_exception());
            throw;
        }
    });
}

hive_code hive_output_repeat(hive_output* output, const hive_event* event)
{
    return guarded([&] { for_user_thread(output)->repeat(get<EventObject>(event)->copy()); });
}

hive_code hive_output_end(hive_output* output, const char* text)
{
    return guarded([&] { for_user_thread(output)->end(text_or_empty(text)); });
}

hive_code hive_output_begin_source(hive_output* output)
{
    return guarded([&] { for_user_thread(output)->begin_source(); });
}
