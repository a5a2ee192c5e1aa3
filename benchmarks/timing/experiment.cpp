#include "experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

#include <time.h>

namespace busbar::timing {

namespace {

/// The times of one class of inputs, in microseconds.
using Times = std::vector<double>;

struct Summary {
    std::size_t count{0};
    double median{0};
    double mean{0};
    double variance{0};
};

constexpr double threshold = 4.5;

/// Needs at least two times.
Summary summarize(Times times)
{
    Summary summary;
    summary.count = times.size();
    const auto count = static_cast<double>(times.size());
    std::sort(times.begin(), times.end());
    summary.median = times[times.size() / 2];
    summary.mean = std::accumulate(times.begin(), times.end(), 0.0) / count;
    for (const double time : times) {
        summary.variance += (time - summary.mean) * (time - summary.mean) / (count - 1);
    }
    return summary;
}

/// What that share of all times together does not exceed. Longer ones are not looked at: there the
/// operating system was at work.
double quantile(const std::vector<Times>& classes, double share)
{
    Times all;
    for (const Times& times : classes) {
        all.insert(all.end(), times.begin(), times.end());
    }
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), all.begin() + at, all.end());
    return all[static_cast<std::size_t>(at)];
}

/// Welch's t: how many standard errors the means of two classes are apart. Beyond 4.5 it is no
/// chance any more (the threshold of ISO/IEC 17825 and of "dude, is my code constant time?").
double welch_t(const Summary& a, const Summary& b)
{
    const double error = std::sqrt(a.variance / static_cast<double>(a.count) +
                                   b.variance / static_cast<double>(b.count));
    return error > 0 ? (a.mean - b.mean) / error : 0;
}

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
