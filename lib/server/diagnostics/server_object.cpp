#include "server_object.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

DateTime wall_time(const DiagnosticsNeeds& needs)
{
    return needs.wall_clock.now();
}

Array<String> strings(const std::vector<std::string>& texts)
{
    Array<String> result;
    result.reserve(texts.size());
    for (const std::string& text : texts) {
        result.emplace_back(text);
    }
    return result;
}

Array<String> namespaces(const DiagnosticsNeeds& needs)
{
    Array<String> uris;
    for (std::size_t i = 0; i < needs.space.namespace_count(); ++i) {
        uris.emplace_back(needs.space.namespace_uri(static_cast<std::uint16_t>(i)));
    }
    return uris;
}

/// Returns the locales of all texts: the configured ones, followed by those of models.
Array<String> locale_ids(const DiagnosticsNeeds& needs)
{
    const std::vector<std::string>& configured = needs.config.locale_ids;
    Array<String> all = strings(configured);
    for (const std::string& locale : needs.space.further_locales()) {
        if (std::find(configured.begin(), configured.end(), locale) == configured.end()) {
            all.emplace_back(locale);
        }
    }
    return all;
}

BuildInfo build_info(const DiagnosticsNeeds& needs)
{
    const BuildDescription& build = needs.config.build;
    BuildInfo info;
    info.product_uri = needs.config.product_uri;
    info.manufacturer_name = build.manufacturer_name;
    info.product_name = needs.config.application_name;
    info.software_version = build.software_version;
    info.build_number = build.build_number;
    info.build_date = build.build_date;
    return info;
}

std::uint32_t seconds_till_shutdown(const DiagnosticsNeeds& needs)
{
    const std::int64_t left = needs.life.shutdown_time.ticks - wall_time(needs).ticks;
    return needs.life.is_shutting_down() && left > 0
               ? static_cast<std::uint32_t>(left / DateTime::ticks_per_second)
               : 0;
}

/// Returns what clients may expect (Part 4, 6.6.2.4.2). Clients should not use a suspended server
/// until its EstimatedReturnTime; a failed one returns nothing but its state.
std::uint8_t service_level(ServerState state)
{
    constexpr std::uint8_t maintenance = 0;
    constexpr std::uint8_t no_data = 1;
    constexpr std::uint8_t healthy = 255;
    switch (state) {
    case ServerState::Running:
        return healthy;
    case ServerState::Failed:
        return no_data;
    default:
        return maintenance;
    }
}

/// Null unless there is a reason (Part 5, 12.10).
LocalizedText shutdown_reason(const DiagnosticsNeeds& needs)
{
    return needs.life.is_shutting_down() ? LocalizedText{String{needs.life.shutdown_reason}}
                                         : LocalizedText{};
}

ServerStatusDataType server_status(const DiagnosticsNeeds& needs)
{
    ServerStatusDataType status;
    status.start_time = needs.life.start_time;
    status.current_time = wall_time(needs);
    status.state = needs.life.state;
    status.build_info = build_info(needs);
    status.seconds_till_shutdown = seconds_till_shutdown(needs);
    status.shutdown_reason = shutdown_reason(needs);
    return status;
}

/// Returns the profiles of Part 7 that are implemented in full.
Array<String> profiles(const DiagnosticsNeeds& needs)
{
    Array<String> uris;
    for (const ProfileAssessment& profile : needs.conformance.profiles) {
        if (profile.is_claimed && !profile.is_client) {
            uris.emplace_back(profile.uri);
        }
    }
    return uris;
}

Array<QualifiedName> conformance_units(const DiagnosticsNeeds& needs)
{
    Array<QualifiedName> names(0);
    for (const std::string_view unit : needs.conformance.units) {
        names.emplace_back(std::uint16_t{0}, String{unit});
    }
    return names;
}

/// Returns a VersionTime (Part 4, 7.43): seconds since 2000. Namespaces are only ever added, and a
/// restarted server has a later time.
std::uint32_t uris_version(const DiagnosticsNeeds& needs)
{
    constexpr std::int64_t unix_year_2000 = 946'684'800;
    const std::int64_t since =
        needs.life.start_time.ticks - DateTime::from_unix_seconds(unix_year_2000).ticks;
    return static_cast<std::uint32_t>(since / DateTime::ticks_per_second +
                                      static_cast<std::int64_t>(needs.space.namespace_count()));
}

TimeZoneDataType local_time(const DiagnosticsNeeds& needs)
{
    const TimeZone zone = needs.wall_clock.time_zone();
    return {zone.offset, zone.daylight_saving_in_offset};
}

struct LiveValue {
    std::uint32_t id;
    Variant (*make)(const DiagnosticsNeeds& needs);
};

std::uint32_t count(std::size_t value)
{
    return static_cast<std::uint32_t>(std::min<std::size_t>(value, UINT32_MAX));
}

/// The Server object (Part 5, 6.3.1) and its ServerStatus (Part 5, 12.10).
constexpr std::array status_values{
    LiveValue{id::Server_ServerArray,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return Array<String>{c.config.application_uri};
              }},
    LiveValue{id::Server_NamespaceArray,
              [](const DiagnosticsNeeds& c) -> Variant { return namespaces(c); }},
    LiveValue{id::Server_ServerStatus,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return ExtensionObject::from(server_status(c));
              }},
    LiveValue{id::Server_ServerStatus_StartTime,
              [](const DiagnosticsNeeds& c) -> Variant { return c.life.start_time; }},
    LiveValue{id::Server_ServerStatus_CurrentTime,
              [](const DiagnosticsNeeds& c) -> Variant { return wall_time(c); }},
    LiveValue{id::Server_ServerStatus_State,
              [](const DiagnosticsNeeds& c) -> Variant { return c.life.state; }},
    LiveValue{
        id::Server_ServerStatus_BuildInfo,
        [](const DiagnosticsNeeds& c) -> Variant { return ExtensionObject::from(build_info(c)); }},
    LiveValue{
        id::Server_ServerStatus_BuildInfo_ProductName,
        [](const DiagnosticsNeeds& c) -> Variant { return String{c.config.application_name}; }},
    LiveValue{id::Server_ServerStatus_BuildInfo_ProductUri,
              [](const DiagnosticsNeeds& c) -> Variant { return String{c.config.product_uri}; }},
    LiveValue{id::Server_ServerStatus_BuildInfo_ManufacturerName,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return String{c.config.build.manufacturer_name};
              }},
    LiveValue{id::Server_ServerStatus_BuildInfo_SoftwareVersion,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return String{c.config.build.software_version};
              }},
    LiveValue{
        id::Server_ServerStatus_BuildInfo_BuildNumber,
        [](const DiagnosticsNeeds& c) -> Variant { return String{c.config.build.build_number}; }},
    LiveValue{id::Server_ServerStatus_BuildInfo_BuildDate,
              [](const DiagnosticsNeeds& c) -> Variant { return c.config.build.build_date; }},
    LiveValue{id::Server_ServerStatus_SecondsTillShutdown,
              [](const DiagnosticsNeeds& c) -> Variant { return seconds_till_shutdown(c); }},
    LiveValue{id::Server_ServerStatus_ShutdownReason,
              [](const DiagnosticsNeeds& c) -> Variant { return shutdown_reason(c); }},
    LiveValue{id::Server_ServiceLevel,
              [](const DiagnosticsNeeds& c) -> Variant { return service_level(c.life.state); }},
    LiveValue{id::Server_UrisVersion,
              [](const DiagnosticsNeeds& c) -> Variant { return uris_version(c); }},
    LiveValue{
        id::Server_LocalTime,
        [](const DiagnosticsNeeds& c) -> Variant { return ExtensionObject::from(local_time(c)); }},
    LiveValue{id::Server_EstimatedReturnTime,
              [](const DiagnosticsNeeds& c) -> Variant { return c.life.return_time; }},
    LiveValue{id::Server_Auditing,
              [](const DiagnosticsNeeds& needs) -> Variant { return needs.config.is_auditing; }},
    LiveValue{id::Server_ServerRedundancy_RedundancySupport,
              [](const DiagnosticsNeeds&) -> Variant { return RedundancySupport::None; }},
};

/// ServerCapabilities (Part 5, 6.3.2) with the OperationLimits (Part 5, 6.3.11).
constexpr std::array capability_values{
    LiveValue{id::Server_ServerCapabilities_ServerProfileArray,
              [](const DiagnosticsNeeds& c) -> Variant { return profiles(c); }},
    LiveValue{id::Server_ServerCapabilities_ConformanceUnits,
              [](const DiagnosticsNeeds& c) -> Variant { return conformance_units(c); }},
    LiveValue{id::Server_ServerCapabilities_LocaleIdArray,
              [](const DiagnosticsNeeds& c) -> Variant { return locale_ids(c); }},
    LiveValue{id::Server_ServerCapabilities_MinSupportedSampleRate,
              [](const DiagnosticsNeeds& c) -> Variant {
                  const auto& policy = c.limits().subscriptions.sampling;
                  return static_cast<double>(policy.min_interval.count());
              }},
    LiveValue{id::Server_ServerCapabilities_SoftwareCertificates,
              [](const DiagnosticsNeeds&) -> Variant { return Array<ExtensionObject>(0); }},
    LiveValue{id::Server_ServerCapabilities_MaxBrowseContinuationPoints,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().max_browse_continuation_points;
              }},
    LiveValue{id::Server_ServerCapabilities_MaxQueryContinuationPoints,
              [](const DiagnosticsNeeds&) -> Variant { return std::uint16_t{0}; }},
    LiveValue{id::Server_ServerCapabilities_MaxHistoryContinuationPoints,
              [](const DiagnosticsNeeds&) -> Variant { return std::uint16_t{0}; }},
    LiveValue{
        id::Server_ServerCapabilities_MaxArrayLength,
        [](const DiagnosticsNeeds& c) -> Variant { return c.limits().decode.max_array_length; }},
    LiveValue{
        id::Server_ServerCapabilities_MaxStringLength,
        [](const DiagnosticsNeeds& c) -> Variant { return c.limits().decode.max_string_length; }},
    LiveValue{id::Server_ServerCapabilities_MaxByteStringLength,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().decode.max_byte_string_length;
              }},
    LiveValue{id::Server_ServerCapabilities_MaxSessions,
              [](const DiagnosticsNeeds& c) -> Variant { return count(c.limits().max_sessions); }},
    LiveValue{id::Server_ServerCapabilities_MaxSubscriptions,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().subscriptions.max_subscriptions);
              }},
    LiveValue{id::Server_ServerCapabilities_MaxMonitoredItems,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().subscriptions.max_items);
              }},
    LiveValue{id::Server_ServerCapabilities_MaxSubscriptionsPerSession,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().subscriptions.max_subscriptions_per_session);
              }},
    LiveValue{id::Server_ServerCapabilities_MaxMonitoredItemsPerSubscription,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().subscriptions.max_items_per_subscription);
              }},
    LiveValue{id::Server_ServerCapabilities_MaxMonitoredItemsQueueSize,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().subscriptions.max_queue_size;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxMonitoredItemsPerCall,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_monitored_items_per_call;
              }},
    LiveValue{id::Server_ServerCapabilities_MaxSelectClauseParameters,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().events.filter.max_select_clauses);
              }},
    LiveValue{id::Server_ServerCapabilities_MaxWhereClauseParameters,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return count(c.limits().events.filter.max_elements);
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRead,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_read;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerWrite,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_write;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerMethodCall,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_method_call;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerNodeManagement,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_node_management;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerBrowse,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_browse;
              }},
    LiveValue{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRegisterNodes,
              [](const DiagnosticsNeeds& c) -> Variant {
                  return c.limits().operations.max_nodes_per_register_nodes;
              }},
    LiveValue{
        id::Server_ServerCapabilities_OperationLimits_MaxNodesPerTranslateBrowsePathsToNodeIds,
        [](const DiagnosticsNeeds& c) -> Variant {
            return c.limits().operations.max_nodes_per_translate_browse_paths;
        }},
};

constexpr auto live_values = [] {
    std::array<LiveValue, status_values.size() + capability_values.size()> all{};
    std::copy(status_values.begin(), status_values.end(), all.begin());
    std::copy(capability_values.begin(), capability_values.end(),
              all.begin() + status_values.size());
    std::sort(all.begin(), all.end(),
              [](const LiveValue& a, const LiveValue& b) { return a.id < b.id; });
    return all;
}();

} // namespace

Result<DataValue> ServerObject::find(const NodeId& node, const ReadingUser& reader) const
{
    if (node.namespace_index() == 0 && node.is_numeric()) {
        const auto* const found = std::lower_bound(
            live_values.begin(), live_values.end(), node.numeric(),
            [](const LiveValue& value, std::uint32_t number) { return value.id < number; });
        if (found != live_values.end() && found->id == node.numeric()) {
            return DataValue{found->make(needs_), status::Good, wall_time(needs_)};
        }
    }
    if (others_ == nullptr) {
        return fail(status::Bad_NodeIdUnknown);
    }
    return others_->find(node, reader);
}

void list_modelling_rules(model::AddressSpace& space)
{
    const model::NodeIndex folder = space.find(id::Server_ServerCapabilities_ModellingRules);
    for (const std::uint32_t rule :
         {id::ModellingRule_Mandatory, id::ModellingRule_Optional,
          id::ModellingRule_ExposesItsArray, id::ModellingRule_OptionalPlaceholder,
          id::ModellingRule_MandatoryPlaceholder}) {
        const model::NodeIndex node = space.find(rule);
        if (folder != model::no_node && node != model::no_node) {
            static_cast<void>(space.add_reference(folder, NodeId{0, id::Organizes}, node));
        }
    }
}

} // namespace busbar::server::detail
