// One slot under a mutex.
#include "exchange.hpp"

namespace view {

void Exchange::put(std::shared_ptr<const Picture> picture, Time now)
{
    Newest next{std::move(picture), 0, now};
    {
        const std::lock_guard lock(mutex_);
        next.number = newest_.number + 1;
        std::swap(newest_, next);
    }  // the pixels of the former one are given back outside of the lock
}

Exchange::Newest Exchange::newest() const
{
    const std::lock_guard lock(mutex_);
    return newest_;
}

double Rate::count(Time now)
{
    times_.push_back(now);
    while (times_.size() > 2 && times_.front() < now - std::chrono::seconds(2))
        times_.pop_front();
    const std::chrono::duration<double> span = now - times_.front();
    return span.count() > 0 ? static_cast<double>(times_.size() - 1) / span.count() : 0;
}

}  // namespace view
