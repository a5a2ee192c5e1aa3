#include "server_configuration.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/administration/server_configuration_nodes/nodes.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "method_record.hpp"
#include "own_certificate_methods.hpp"

namespace busbar::administration::detail {

namespace {

/// NodeIds of Part 6, Annex A, for optional instances that the type only declares.
namespace instance {
constexpr std::uint32_t in_application_setup = 19309;
constexpr std::uint32_t create_self_signed_certificate = 19342;
constexpr std::uint32_t delete_certificate = 19345;
constexpr std::uint32_t get_certificates = 32333;
} // namespace instance

/// Explains a status of Transaction::check_end.
const char* reason_of_end(StatusCode state)
{
    return state == status::Bad_NothingToDo
               ? "no changes of certificates or trust lists are waiting to be applied"
               : "the changes belong to another session, which must apply or cancel them";
}

using server::MethodCall;

/// Maximum size of the certificates in an answer of GetRejectedList (Part 12, 7.10.12 allows
/// leaving older ones out).
constexpr std::size_t max_rejected_bytes = 1U << 20U;

} // namespace

ServerConfiguration::ServerConfiguration(server::Server& server, const ManagedCertificates& files,
                                         NodeTable& table, const WallClock& clock, LogSink& log,
                                         server::Worker* worker,
                                         const std::function<bool()>& is_in_setup)
    : server_{server}, space_{server.address_space()}, files_{files}, table_{table}, clock_{clock},
      log_{log}, is_in_setup_{is_in_setup}, transaction_{files, clock}, own_{{server, files, table,
                                                                              clock, log, worker,
                                                                              transaction_}}
{
}

Configured<void> ServerConfiguration::attach()
{
    if (auto finished = finish_changes(*files_.files); !finished) {
        return finished;
    }
    if (auto added = add_nodes(); !added) {
        return added;
    }
    bind_values();
    bind_diagnostics();
    bind_own(space_.find(id::ServerConfiguration_UpdateCertificate),
             &OwnCertificateMethods::update);
    bind_own(space_.find(id::ServerConfiguration_CreateSigningRequest),
             &OwnCertificateMethods::create_signing_request);
    bind(id::ServerConfiguration_GetRejectedList, &ServerConfiguration::get_rejected_list);
    bind(id::ServerConfiguration_ApplyChanges, &ServerConfiguration::apply_changes);
    bind(id::ServerConfiguration_CancelChanges, &ServerConfiguration::cancel_changes);
    add_group(id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup,
              *files_.applications, "", crypto::CertificatePurpose::Application);
    const auto users = space_.find(id::ServerConfiguration_CertificateGroups_DefaultUserTokenGroup);
    if (files_.users != nullptr) {
        add_group(id::ServerConfiguration_CertificateGroups_DefaultUserTokenGroup, *files_.users,
                  files_.users_folder, crypto::CertificatePurpose::User);
    } else if (users != model::no_node) {
        static_cast<void>(space_.remove(users));
    }
    return {};
}

Configured<void> ServerConfiguration::add_nodes()
{
    if (const auto added = space_.add(server_configuration_nodes::nodes()); !added) {
        return misconfigured("certificates", "the nodes of ServerConfiguration cannot be added",
                             added.error());
    }
    auto done = add_method({"GetCertificates", id::ServerConfigurationType_GetCertificates,
                            instance::get_certificates},
                           &OwnCertificateMethods::get);
    done = done ? add_method({"CreateSelfSignedCertificate",
                              id::ServerConfigurationType_CreateSelfSignedCertificate,
                              instance::create_self_signed_certificate},
                             &OwnCertificateMethods::create_self_signed)
                : done;
    done = done ? add_remove_rejected() : done;
    done = done ? add_setup() : done;
    done = done ? add_own_certificate(server_, table_, files_.configured) : done;
    return done ? add_method({"DeleteCertificate", id::ServerConfigurationType_DeleteCertificate,
                              instance::delete_certificate},
                             &OwnCertificateMethods::remove)
                : done;
}

Configured<void> ServerConfiguration::add_method(const StandardMethod& what, OwnMethod method)
{
    const model::NodeIndex type = space_.find(what.declaration);
    const model::NodeIndex parent = space_.find(id::ServerConfiguration);
    model::NewNode node;
    node.id = NodeId{0, what.instance};
    node.browse_name = QualifiedName{0, what.name};
    node.parent = parent;
    node.reference_type = NodeId{0, id::HasComponent};
    model::NewMethod facts;
    facts.input_arguments = declared_arguments(space_, type, "InputArguments");
    facts.output_arguments = declared_arguments(space_, type, "OutputArguments");
    const auto made = space_.add_method(node, facts);
    if (!made) {
        return misconfigured("certificates",
                             "the Method " + std::string{what.name} + " cannot be added",
                             made.error());
    }
    bind_own(*made, method);
    return {};
}

Configured<void> ServerConfiguration::add_remove_rejected()
{
    const auto own = space_.namespace_index(server_.config().application_uri);
    model::NewNode node;
    node.id = NodeId{own.value_or(1), "ServerConfiguration/RemoveRejectedCertificate"};
    node.browse_name = QualifiedName{own.value_or(1), "RemoveRejectedCertificate"};
    node.parent = space_.find(id::ServerConfiguration);
    node.reference_type = NodeId{0, id::HasComponent};
    model::NewMethod facts;
    Argument thumbprint;
    thumbprint.name = "Thumbprint";
    thumbprint.data_type = NodeId{0, id::String};
    thumbprint.value_rank = -1;
    facts.input_arguments.push_back(std::move(thumbprint));
    const auto made = space_.add_method(node, facts);
    if (!made) {
        return misconfigured("certificates", "RemoveRejectedCertificate cannot be added",
                             made.error());
    }
    table_.bind_method(space_, *made, [this](MethodCall call) {
        expire();
        remove_rejected(std::move(call));
    });
    return {};
}

Configured<void> ServerConfiguration::add_setup()
{
    if (!is_in_setup_) {
        return {};
    }
    model::NewNode node;
    node.id = NodeId{0, instance::in_application_setup};
    node.browse_name = QualifiedName{0, "InApplicationSetup"};
    node.parent = space_.find(id::ServerConfiguration);
    node.reference_type = NodeId{0, id::HasProperty};
    model::NewVariable facts;
    facts.type_definition = NodeId{0, id::PropertyType};
    facts.data_type = NodeId{0, id::Boolean};
    facts.value = false;
    const auto made = space_.add_variable(node, facts);
    if (!made) {
        return misconfigured("certificates", "InApplicationSetup cannot be added", made.error());
    }
    table_.bind_value(space_, *made, [this] { return Variant{is_in_setup_()}; });
    return {};
}

void ServerConfiguration::bind_own(model::NodeIndex node, OwnMethod method)
{
    table_.bind_method(space_, node, [this, method](MethodCall call) {
        expire();
        (own_.*method)(std::move(call));
    });
}

void ServerConfiguration::bind(std::uint32_t node, Method method)
{
    table_.bind_method(space_, space_.find(node), [this, method](MethodCall call) {
        expire();
        (this->*method)(std::move(call));
    });
}

void ServerConfiguration::bind_values()
{
    const auto bind_one = [&](std::uint32_t node, NodeTable::Value value) {
        table_.bind_value(space_, space_.find(node), std::move(value));
    };
    bind_one(id::ServerConfiguration_ApplicationUri,
             [this] { return Variant{String{server_.config().application_uri}}; });
    bind_one(id::ServerConfiguration_ProductUri,
             [this] { return Variant{String{server_.config().product_uri}}; });
    bind_one(id::ServerConfiguration_ApplicationType,
             [] { return Variant{static_cast<std::int32_t>(ApplicationType::Server)}; });
    // The value for servers that do not tell (Part 12, Annex D).
    bind_one(id::ServerConfiguration_ServerCapabilities, [] { return texts({"NA"}); });
    bind_one(id::ServerConfiguration_SupportedPrivateKeyFormats,
             [] { return texts({std::string{private_key_format}}); });
    bind_one(id::ServerConfiguration_MaxTrustListSize,
             [this] { return Variant{static_cast<std::uint32_t>(files_.max_trust_list_size)}; });
    bind_one(id::ServerConfiguration_MulticastDnsEnabled, [] { return Variant{false}; });
    bind_one(id::ServerConfiguration_HasSecureElement, [] { return Variant{false}; });
}

/// Part 12, 7.10.17: Bad_OutOfService before the first transaction.
void ServerConfiguration::bind_diagnostics()
{
    const auto bind_one = [&](std::uint32_t node, std::function<Variant()> value) {
        table_.bind_value(space_, space_.find(node), [this, value = std::move(value)] {
            expire();
            return transaction_.has_begun() ? DataValue{value()}
                                            : DataValue{status::Bad_OutOfService};
        });
    };
    bind_one(id::ServerConfiguration_TransactionDiagnostics_StartTime,
             [this] { return Variant{transaction_.start_time()}; });
    bind_one(id::ServerConfiguration_TransactionDiagnostics_EndTime,
             [this] { return Variant{transaction_.end_time()}; });
    bind_one(id::ServerConfiguration_TransactionDiagnostics_Result,
             [this] { return Variant{transaction_.result()}; });
    bind_one(id::ServerConfiguration_TransactionDiagnostics_AffectedTrustLists,
             [this] { return node_ids(transaction_.affected_trust_lists()); });
    bind_one(id::ServerConfiguration_TransactionDiagnostics_AffectedCertificateGroups,
             [this] { return node_ids(transaction_.affected_groups()); });
    bind_one(id::ServerConfiguration_TransactionDiagnostics_Errors,
             [this] { return structures<TransactionErrorType>(transaction_.errors()); });
}

void ServerConfiguration::add_group(std::uint32_t group, crypto::CertificateStore& store,
                                    std::string folder, crypto::CertificatePurpose purpose)
{
    const model::NodeIndex node = space_.find(group);
    const model::NodeIndex list = child_of(space_, node, "TrustList");
    const std::size_t index = transaction_.groups().size();
    transaction_.groups().push_back(
        {space_.node_id(node), space_.node_id(list), &store, std::move(folder), purpose, 0});
    const bool has_own = purpose == crypto::CertificatePurpose::Application;
    table_.bind_value(space_, child_of(space_, node, "CertificateTypes"), [has_own] {
        return has_own ? node_ids({NodeId{0, certificate_type}}) : node_ids({});
    });
    trust_lists_.emplace_back(
        TrustListNeeds{server_, table_, transaction_, files_, clock_, log_,
                       table_.add_signal([this, index] { trust_changed(index); })},
        index);
    trust_lists_.back().attach(list);
}

void ServerConfiguration::expire()
{
    for (TrustListFile& list : trust_lists_) {
        list.expire();
    }
}

/// Part 12, 7.10.12.
void ServerConfiguration::get_rejected_list(MethodCall call)
{
    Array<ByteString> ders;
    ders.clear();
    std::size_t size = 0;
    for (const CertificateGroup& group : transaction_.groups()) {
        for (const crypto::StoreEntry& entry : group.store->list(crypto::StoreList::Rejected)) {
            const auto bytes = read_file(group.store->storage(), entry.file, max_rejected_bytes);
            const auto certificate =
                bytes ? crypto::Certificate::parse_file(*bytes)
                      : Result<crypto::Certificate>{Unexpected{status_of(bytes.error())}};
            if (!certificate || size + certificate->der().size() > max_rejected_bytes) {
                continue;
            }
            size += certificate->der().size();
            ders.push_back(ByteString{certificate->der()});
        }
    }
    call.succeed(one_output(Variant{std::move(ders)}));
}

/// Removes the certificate from all groups that have it, because GetRejectedList does not tell them
/// apart either.
void ServerConfiguration::remove_rejected(MethodCall call)
{
    const std::string thumbprint = crypto::spelled_thumbprint(text_view(call, 0));
    // Look at all groups first, so that a lack of memory there leaves the certificate in each.
    std::vector<crypto::CertificateStore*> stores;
    for (const CertificateGroup& group : transaction_.groups()) {
        const auto entries = group.store->list(crypto::StoreList::Rejected);
        if (std::any_of(entries.begin(), entries.end(),
                        [&](const auto& each) { return each.thumbprint == thumbprint; })) {
            stores.push_back(group.store);
        }
    }
    if (stores.empty()) {
        return call.fail(status::Bad_NotFound);
    }
    for (crypto::CertificateStore* const store : stores) {
        const auto removed = store->remove(crypto::StoreList::Rejected, thumbprint);
        if (!removed) {
            return call.fail(removed.error().status);
        }
    }
    call.succeed();
}

/// Part 12, 7.10.9.
void ServerConfiguration::apply_changes(MethodCall call)
{
    if (const StatusCode state = transaction_.check_end(holder_of(server_, call)); state.is_bad()) {
        return call.fail(state, reason_of_end(state));
    }
    const bool is_open =
        std::any_of(trust_lists_.begin(), trust_lists_.end(),
                    [](const TrustListFile& list) { return list.is_open_for_writing(); });
    if (is_open || own_.is_making_key()) {
        return call.fail(status::Bad_InvalidState,
                         is_open ? "a trust list is open for writing; close it first"
                                 : "a private key is being generated; try again when it is done");
    }
    const auto own = std::make_shared<std::optional<crypto::OwnCertificate>>();
    auto put_in_force = std::make_unique<NodeTable::Task>();
    put_in_force->function = [this, own] { renew(**own); };
    auto changed = transaction_.apply(server_.config().application_uri);
    if (!changed) {
        return refuse_call(call, RecordKind::SettingsChanged, changed.error());
    }
    busbar::detail::attempt([&] { tell_applied(call, *changed); });
    call.succeed();
    for (const std::size_t group : changed->groups) {
        trust_lists_[group].tell_changed();
    }
    if (changed->own) {
        *own = std::move(changed->own);
        table_.post(std::move(put_in_force));
    }
}

/// Part 12, 7.10.11.
void ServerConfiguration::cancel_changes(MethodCall call)
{
    if (const StatusCode state = transaction_.check_end(holder_of(server_, call)); state.is_bad()) {
        return call.fail(state, reason_of_end(state));
    }
    transaction_.cancel(status::Bad_RequestCancelledByClient);
    call.succeed();
}

void ServerConfiguration::tell_applied(const MethodCall& call, const Transaction::Changed& changed)
{
    for (const std::size_t group : changed.groups) {
        const std::array fields{
            RecordField{"TrustListId", Variant{transaction_.groups()[group].trust_list_id}}};
        tell_method(log_, RecordKind::TrustListUpdated, call, status::Good, nullptr, fields);
    }
    if (changed.own) {
        const std::array fields{
            RecordField{"CertificateGroup", Variant{transaction_.groups().front().id}},
            RecordField{"CertificateType", Variant{NodeId{0, certificate_type}}}};
        tell_method(log_, RecordKind::CertificateUpdated, call, status::Good, nullptr, fields,
                    changed.own->certificates.front().der());
    }
}

void ServerConfiguration::refuse_call(MethodCall& call, RecordKind kind, const Refusal& refusal)
{
    tell_method(log_, kind, call, refusal.status, &refusal);
    answer_with(call, refusal);
}

void ServerConfiguration::trust_changed(std::size_t group)
{
    const server::RunningServer running{server_};
    if (transaction_.groups()[group].purpose == crypto::CertificatePurpose::Application) {
        running.trust_changed();
        return;
    }
    // Users whose certificate is not in the list itself must log in again, which checks it again.
    const crypto::TrustList list = transaction_.groups()[group].store->trust_list(clock_.now());
    static_cast<void>(running.end_sessions([&](const server::UserIdentity& user) {
        return user.token_type == UserTokenType::Certificate &&
               std::none_of(list.trusted.begin(), list.trusted.end(),
                            [&](const crypto::Certificate& certificate) {
                                return certificate.thumbprint_text() == user.thumbprint;
                            });
    }));
}

void ServerConfiguration::renew(const crypto::OwnCertificate& own)
{
    server::ServerConfig config = server_.config();
    config.identity = channel::ApplicationIdentity{own.certificates, own.key};
    const auto done = server::RunningServer{server_}.reconfigure(std::move(config));
    if (!done) {
        log_.write(LogLevel::Error, "administration",
                   "the new certificate takes effect only after a restart: " + text(done.error()));
        return;
    }
    if (files_.renewed) {
        files_.renewed(own);
    }
}

} // namespace busbar::administration::detail
