#include "field_labels.hpp"

#include <chrono>

namespace busbar::product {

FieldLabels::FieldLabels(const backend::SlmpLabelsOptions& options, const WallClock& clock,
                         LogSink& log)
    : log_{log}, labels_{std::make_shared<backend::SlmpLabels>(
                     options, clock,
                     [] {
                         return std::chrono::time_point_cast<Duration>(
                             std::chrono::steady_clock::now());
                     },
                     log)}
{
}

} // namespace busbar::product
