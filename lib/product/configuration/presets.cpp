#include "presets.hpp"

#include <cstdio>

#include <busbar/server/product_limits.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

namespace {

class Figures {
public:
    Figures() { json_.begin_object(); }

    void add(std::string_view name, std::string_view text)
    {
        json_.name(name);
        json_.string(text);
    }
    void add(std::string_view name, std::size_t figure)
    {
        json_.name(name);
        json_.word(std::to_string(figure));
    }
    void add(std::string_view name, const std::optional<std::uint64_t>& figure)
    {
        if (figure) {
            add(name, static_cast<std::size_t>(*figure));
        }
    }
    void add(std::string_view name, std::chrono::milliseconds time)
    {
        add(name, static_cast<std::size_t>(time.count()));
    }
    [[nodiscard]] std::string take()
    {
        json_.end_object();
        return json_.take() + "\n";
    }

private:
    busbar::detail::JsonWriter json_;
};

void add_services(Figures& figures, const server::ServerLimits& limits)
{
    figures.add("sessions", limits.max_sessions);
    figures.add("min_session_timeout_ms", limits.min_session_timeout);
    figures.add("max_session_timeout_ms", limits.max_session_timeout);
    figures.add("nodes_per_read", limits.operations.max_nodes_per_read);
    figures.add("nodes_per_write", limits.operations.max_nodes_per_write);
    figures.add("nodes_per_browse", limits.operations.max_nodes_per_browse);
    figures.add("nodes_per_translate_browse_paths",
                limits.operations.max_nodes_per_translate_browse_paths);
    figures.add("methods_per_call", limits.operations.max_nodes_per_method_call);
    figures.add("message_size", limits.transport.max_message_size);
    figures.add("string_length", limits.decode.max_string_length);
    figures.add("byte_string_length", limits.decode.max_byte_string_length);
    figures.add("array_length", limits.decode.max_array_length);
}

void add_subscriptions(Figures& figures, const server::SubscriptionLimits& limits)
{
    figures.add("subscriptions", limits.max_subscriptions);
    figures.add("subscriptions_per_session", limits.max_subscriptions_per_session);
    figures.add("items", limits.max_items);
    figures.add("queue_size", limits.max_queue_size);
    figures.add("min_publishing_interval_ms", limits.min_publishing_interval);
    figures.add("min_keep_alive_ms", limits.min_keep_alive);
    figures.add("min_lifetime_ms", limits.min_lifetime);
    figures.add("min_sampling_interval_ms", limits.sampling.min_interval);
    figures.add("max_sampling_interval_ms", limits.sampling.max_interval);
}

void add_users(Figures& figures, const server::PasswordRules& rules)
{
    figures.add("users", rules.max_users);
    figures.add("min_name_length", rules.min_name_length);
    figures.add("max_name_length", rules.max_name_length);
    figures.add("min_password_length", rules.min_password_length);
    figures.add("max_password_length", rules.max_password_length);
    figures.add("reserved_names", rules.reserved_names.size());
}

void add_publishing(Figures& figures, const controller::PublishingLimits& limits)
{
    figures.add("published_variables", limits.max_variables);
    figures.add("published_values", limits.max_values);
    figures.add("published_data_types", limits.max_data_types);
    figures.add("variable_size", limits.max_size);
    figures.add("variable_elements", limits.max_elements);
    figures.add("structure_members", limits.max_members);
    figures.add("structure_levels", limits.max_levels);
}

} // namespace

std::optional<Preset> find_preset(std::string_view name)
{
    if (name == "nj501") {
        return Preset{"nj501",
                      server::nj501_limits(),
                      crypto::nj501_store_limits(),
                      server::nj501_password_rules(),
                      controller::nj501_publishing(),
                      controller::nj501_types(),
                      nj501_subject()};
    }
    if (name == "nx102") {
        return Preset{"nx102",
                      server::nx102_limits(),
                      crypto::nx102_store_limits(),
                      server::nj501_password_rules(),
                      controller::nx102_publishing(),
                      controller::nx102_types(),
                      nj501_subject()};
    }
    if (name == "rd81opc96") {
        return Preset{"rd81opc96", server::rd81opc96_limits(), crypto::rd81opc96_store_limits(),
                      server::rd81opc96_password_rules()};
    }
    return std::nullopt;
}

std::string preset_json(const Preset& preset)
{
    Figures figures;
    figures.add("preset", preset.name);
    add_services(figures, preset.limits);
    add_subscriptions(figures, preset.limits.subscriptions);
    add_users(figures, preset.passwords);
    add_publishing(figures, preset.publishing);
    figures.add("trusted_certificates", preset.store.max_certificates);
    figures.add("issuer_certificates", preset.store.max_certificates);
    figures.add("rejected_certificates", preset.store.max_rejected);
    return figures.take();
}

int print_preset(const std::string& name)
{
    const auto preset = find_preset(name);
    if (!preset) {
        std::fprintf(stderr, "busbar-controller: found the preset \"%s\", expected %.*s\n",
                     name.c_str(), static_cast<int>(preset_names.size()), preset_names.data());
        return 2;
    }
    std::fputs(preset_json(*preset).c_str(), stdout);
    return 0;
}

} // namespace busbar::product
