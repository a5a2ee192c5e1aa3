#include "experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <time.h>

#include "statistics.hpp"

namespace busbar::timing {

namespace {

/// Of all times the longest tenth is left out.
constexpr double kept_share = 0.9;
constexpr std::size_t warm_up = 50; // of each class

/// Microseconds that this thread has worked: what a refusal costs, whatever else the machine does.
/// An engine neither waits nor hands anything to another thread.
double worked()
{
    timespec time = {};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

double timed(const Attempt& attempt)
{
    const double start = worked();
    attempt();
    return worked() - start;
}

/// Each class as often as is wanted, in random order.
std::vector<std::size_t> schedule(std::size_t classes, const Settings& settings)
{
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < classes; ++i) {
        order.insert(order.end(), settings.samples + warm_up, i);
    }
    std::shuffle(order.begin(), order.end(), std::mt19937_64{settings.seed});
    return order;
}

/// One bound for all classes that are compared, so that none is favoured; a control has its own.
void crop_all(const std::vector<InputClass>& classes, std::vector<Times>& times)
{
    std::vector<Times> compared;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (!classes[i].is_control) {
            compared.push_back(times[i]);
        }
    }
    const double bound = quantile(compared, kept_share);
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const double own = classes[i].is_control ? quantile({times[i]}, kept_share) : bound;
        std::erase_if(times[i], [&](double time) { return time > own; });
    }
}

} // namespace

std::size_t run(const std::string& title, const std::vector<InputClass>& classes,
                const Settings& settings)
{
    std::vector<Times> times(classes.size());
    for (const std::size_t which : schedule(classes.size(), settings)) {
        times[which].push_back(timed(classes[which].prepare()));
    }
    for (Times& of_class : times) {
        of_class.erase(of_class.begin(), of_class.begin() + warm_up);
    }
    crop_all(classes, times);
    std::printf("\n%s\n  %-34s %6s %10s %10s %8s\n", title.c_str(), "class", "n", "median us",
                "mean us", "t");
    std::size_t told_apart = 0;
    const Summary first = summarize(times[0]);
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const Summary summary = summarize(times[i]);
        const double t = welch_t(summary, first);
        const bool differs = std::abs(t) >= threshold;
        told_apart += differs && !classes[i].is_control ? 1U : 0U;
        std::printf("  %-34s %6zu %10.1f %10.1f %8.2f  %s\n", classes[i].name.c_str(),
                    summary.count, summary.median, summary.mean, t,
                    classes[i].is_control ? (differs ? "differs, as it is to" : "NOT NOTICED")
                    : differs             ? "DIFFERS"
                                          : "alike");
    }
    return told_apart;
}

} // namespace busbar::timing
