// Jobs that run when the world schedules them.
#include "world.hpp"

#include <hive/event/encoder_thread.hpp>

#include <memory>
#include <unordered_map>

namespace hive::event {
namespace {

std::unordered_map<const EncoderThread*, std::shared_ptr<bool>>& alive()
{
    static std::unordered_map<const EncoderThread*, std::shared_ptr<bool>> all;
    return all;
}

}  // namespace

void EncoderThread::push(const std::string&, Job job)
{
    using namespace std::chrono_literals;
    auto& mine = alive()[this];
    if (!mine)
        mine = std::make_shared<bool>(true);
    auto& world = simulation::world();
    world.at(world.now() + 2ms, [weak = std::weak_ptr(mine), job = std::move(job)] {
        if (weak.lock())
            job();
    });
}

std::chrono::nanoseconds EncoderThread::worked() const { return {}; }

void EncoderThread::end() { alive().erase(this); }

}  // namespace hive::event
