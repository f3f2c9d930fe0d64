// Keeps one slot under a mutex.
#include "exchange.hpp"

#include <utility>

namespace view {

void Exchange::put(std::shared_ptr<const Image> image, Time now)
{
    Newest next{std::move(image), 0, now, 0};
    {
        const std::lock_guard lock(mutex_);
        next.number = newest_.number + 1;
        next.version = newest_.version + 1;
        captioned_ = now;
        std::swap(newest_, next);
    }  // the pixels of the former one are released without the lock
}

Exchange::Newest Exchange::newest(Time now) const
{
    std::shared_ptr<const Image> former;  // its pixels are released without the lock
    const std::lock_guard lock(mutex_);
    if (newest_.number > 0 && !newest_.going_on(now) && now - captioned_ >= caption_every) {
        captioned_ = now;
        if (auto updated = newest_.image->recaptioned()) {
            former = std::exchange(newest_.image, std::move(updated));
            ++newest_.version;
        }
    }
    return newest_;
}

bool Exchange::Newest::going_on(Time now) const
{
    const double waited_s = std::chrono::duration<double>(now - since).count(), rate = image->origin().rate;
    return waited_s < 2 || (rate > 0 && waited_s < 2 / rate);
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
