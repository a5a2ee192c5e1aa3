#include <busbar/controller/model_limits.hpp>

namespace busbar::controller {

namespace {

LimitState state_of(bool is_exceeded, bool is_detail_exceeded = false)
{
    if (is_exceeded) {
        return LimitState::Exceeded;
    }
    return is_detail_exceeded ? LimitState::DetailExceeded : LimitState::Kept;
}

} // namespace

ModelLimits rd81opc96_model()
{
    ModelLimits limits;
    limits.max_files = 10;
    limits.max_file_size = 20U << 20U;
    limits.max_namespaces = 10;
    limits.max_uri_length = 134;
    limits.max_nodes = 50'000;
    limits.max_variables = 25'000;
    limits.max_variable_words = std::uint64_t{2'048} * 1'024;
    limits.max_node_levels = 20;
    limits.max_structure_levels = 20;
    limits.max_elements = 10'240;
    limits.max_labels = 25'000;
    limits.max_label_length = 800;
    limits.max_total_label_length = 2'500'000;
    limits.supports_all_types = false;
    limits.max_array_length = 25'000;
    limits.max_string_length = 1U << 10U;
    limits.max_byte_string_length = 10U << 10U;
    return limits;
}

StatusBar status_bar(const ModelCounters& counters, const ModelLimits& limits)
{
    StatusBar bar;
    bar.mapping_count = state_of(counters.labels > limits.max_labels,
                                 counters.label_length > limits.max_total_label_length);
    bar.variable_size = state_of(counters.variable_words > limits.max_variable_words,
                                 counters.variables > limits.max_variables);
    bar.file_size = state_of(counters.file_size > limits.max_file_size);
    return bar;
}

} // namespace busbar::controller
