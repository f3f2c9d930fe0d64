// Switches between stacks. A fiber starts with ucontext, which is portable; later switches use longjmp, which needs no
// system call.
#include "fiber.hpp"

#include <csetjmp>
#include <cstring>
#include <cxxabi.h>
#include <new>
#include <sys/mman.h>
#include <ucontext.h>
#include <utility>
#include <vector>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#endif

namespace hive::simulation {
namespace {

constexpr std::size_t guard_size = 4096, stack_size = 256 * 1024;

/// Stacks are reused, because a history has hundreds of threads.
class Stacks {
public:
    ~Stacks()
    {
        for (auto* stack : free_)
            ::munmap(stack, guard_size + stack_size);
    }
    std::byte* take()
    {
        if (free_.empty()) {
            void* const fresh =
                ::mmap(nullptr, guard_size + stack_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
            if (fresh == MAP_FAILED || ::mprotect(fresh, guard_size, PROT_NONE) != 0)
                throw std::bad_alloc();
            return static_cast<std::byte*>(fresh);
        }
        auto* const stack = free_.back();
        free_.pop_back();
        return stack;
    }
    void give(std::byte* stack) { free_.push_back(stack); }

private:
    std::vector<std::byte*> free_;
};

Stacks& stacks()
{
    static Stacks all;
    return all;
}

/// Tells AddressSanitizer which stack is used.
class Switch {
public:
    void to([[maybe_unused]] const void* bottom, [[maybe_unused]] std::size_t size)
    {
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_start_switch_fiber(&fake_, bottom, size);
#endif
    }
    /// For ever.
    static void away([[maybe_unused]] const void* bottom, [[maybe_unused]] std::size_t size)
    {
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_start_switch_fiber(nullptr, bottom, size);
#endif
    }
    void done([[maybe_unused]] const void** bottom = nullptr, [[maybe_unused]] std::size_t* size = nullptr)
    {
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_finish_switch_fiber(fake_, bottom, size);
#endif
    }

private:
    [[maybe_unused]] void* fake_ = nullptr;
};

Fiber* beginning = nullptr;

}  // namespace

struct Fiber::Context {
    /// The state of exceptions belongs to a stack, but the runtime keeps it per thread.
    struct Exceptions {
        void* caught = nullptr;
        unsigned int uncaught = 0;

        void swap()
        {
            auto* const present = reinterpret_cast<Exceptions*>(abi::__cxa_get_globals());
            std::swap(*present, *this);
        }
    };

    std::byte* stack = nullptr;  ///< null before it begins and after it has ended
    jmp_buf inside{}, outside{};
    const void* outside_bottom = nullptr;
    std::size_t outside_size = 0;
    Exceptions exceptions;
};

Fiber::Fiber(std::function<void()> main) : main_(std::move(main)), context_(std::make_unique<Context>()) {}
Fiber::~Fiber() = default;

void Fiber::begin()
{
    Fiber& self = *std::exchange(beginning, nullptr);
    Context& context = *self.context_;
    Switch().done(&context.outside_bottom, &context.outside_size);
    self.main_();
    self.main_ = nullptr;
    self.ended_ = true;
    Switch::away(context.outside_bottom, context.outside_size);
    ::_longjmp(context.outside, 1);
}

void Fiber::enter()
{
    Context& context = *context_;
    const bool first = !context.stack;
    if (first)
        context.stack = stacks().take();
    context.exceptions.swap();
    Switch between;
    between.to(context.stack + guard_size, stack_size);
    if (::_setjmp(context.outside) == 0) {
        if (!first)
            ::_longjmp(context.inside, 1);
        ucontext_t start{};
        ::getcontext(&start);
        start.uc_stack.ss_sp = context.stack + guard_size;
        start.uc_stack.ss_size = stack_size;
        ::makecontext(&start, &Fiber::begin, 0);
        beginning = this;
        ::setcontext(&start);
    }
    between.done();
    context_->exceptions.swap();
    if (ended_)
        stacks().give(std::exchange(context_->stack, nullptr));
}

void Fiber::leave()
{
    Context& context = *context_;
    Switch between;
    between.to(context.outside_bottom, context.outside_size);
    if (::_setjmp(context.inside) == 0)
        ::_longjmp(context.outside, 1);
    between.done(&context_->outside_bottom, &context_->outside_size);
}

}  // namespace hive::simulation
