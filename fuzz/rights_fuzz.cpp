#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "administration_script.hpp"
#include "fuzz_script.hpp"
#include "require.hpp"
#include "rights_world.hpp"

namespace rights_fuzz {

using namespace busbar;

namespace {

/// A client with the session of one user or another.
class Actor {
public:
    explicit Actor(World& world) : world_{world} {}

    [[nodiscard]] const std::string& user() const { return user_; }
    /// A session, or another user in the one that is there.
    void log_in(std::string user, bool is_new)
    {
        if (!client_ || client_->is_closed()) {
            auto accepted = world_.server.connect("127.0.0.1", world_.now);
            if (!accepted) { // the server has shut down
                return leave();
            }
            client_.emplace(*std::move(accepted), channel::SecuritySetting{},
                            channel::ChannelEnvironment{.random = &world_.random,
                                                        .wall_clock = &world_.clock,
                                                        .log = &world_.silence},
                            world_.now);
            is_new = true;
        }
        if (is_new || user_.empty()) {
            close();
            if (!client_->create_session()) {
                return;
            }
        }
        const StatusCode activated = client_->activate(
            test::user_token(crypto::policy_none(), user, password, client_->server_nonce));
        if (activated.is_good()) {
            user_ = std::move(user);
        }
    }
    void close()
    {
        if (client_ && !user_.empty()) {
            static_cast<void>(client_->close_session());
        }
        user_.clear();
    }
    /// Ends the connection without a word.
    void leave()
    {
        client_.reset();
        user_.clear();
    }
    template <typename Request>
    void send(Request request)
    {
        if (client_) {
            client_->messages.clear();
            last_ = client_->send(std::move(request));
        }
    }
    /// The answer to the last Call, if it has come.
    [[nodiscard]] std::optional<CallMethodResult> result()
    {
        const auto response =
            client_ ? client_->take<CallResponse>(last_) : fail(status::Bad_WouldBlock);
        if (!response || response->results.size() != 1) {
            return {};
        }
        return response->results[0];
    }
    void run()
    {
        if (client_) {
            client_->run();
        }
    }

private:
    World& world_;
    std::optional<test::TestClient> client_;
    std::string user_;
    std::uint32_t last_{0};
};

/// Two users who do what they may and what they may not, on one world.
class Play {
public:
    explicit Play(World& world) : world_{world}, actors_{Actor{world}, Actor{world}} {}

    void run(fuzz::Script script)
    {
        actors_[0].log_in("ann", true);
        actors_[1].log_in("bob", true);
        settle();
        check({});
        for (int i = 0; i < 40 && !script.is_over(); ++i) {
            step(script);
        }
    }
    /// False if the world is of no more use.
    [[nodiscard]] bool end()
    {
        while (!world_.worker.jobs.empty()) {
            work();
        }
        for (Actor& actor : actors_) {
            actor.leave();
        }
        for (int i = 0; i < 100 && world_.server.session_count() != 0; ++i) {
            world_.now += std::chrono::minutes{3};
            world_.server.handle_deadline(world_.now);
            settle();
        }
        check({});
        return world_.server.session_count() == 0 && restore() &&
               server::RunningServer{world_.server}.change_state(ServerState::Running, "", {}) &&
               looks_unused();
    }

private:
    void step(fuzz::Script& script)
    {
        const std::uint8_t choice = script.byte();
        Actor& actor = actors_[choice % 2];
        switch (choice / 2 % 16) {
        case 0:
            pass(std::chrono::seconds{script.byte()});
            return;
        case 1:
            work();
            return;
        case 2:
            log_in(actor, script);
            return;
        case 3:
            actor.close();
            break;
        case 4:
            decide(script);
            return;
        case 5:
            world_.medium.set_protected(script.byte() % 4 == 0);
            return;
        case 6:
            actor.leave();
            break;
        case 7:
            write_setting(actor, script);
            return;
        case 8:
            write_transferred(actor, script);
            return;
        default:
            call(actor, script);
            return;
        }
        settle();
        check(late());
    }
    void pass(Duration time)
    {
        auto askers = late();
        world_.now += time;
        world_.server.handle_deadline(world_.now);
        settle();
        check(std::move(askers));
    }
    /// What is done is done for those who had the right when the job was given to the worker;
    /// what comes after it, for those who have it now.
    void work()
    {
        if (world_.worker.jobs.empty()) {
            return;
        }
        auto askers = late();
        const std::vector<Asker> begun = world_.worker.work();
        settle();
        askers.insert(askers.end(), begun.begin(), begun.end());
        check(std::move(askers));
    }
    void log_in(Actor& actor, fuzz::Script& script)
    {
        static constexpr std::array names{"ann", "bob", "x"};
        const std::uint8_t choice = script.byte();
        auto askers = late();
        actor.log_in(names[choice % names.size()], choice % 2 == 0);
        settle();
        check(std::move(askers));
    }
    /// Somebody else gives a right, or takes it.
    void decide(fuzz::Script& script)
    {
        static constexpr std::array roles{"SecurityAdmin", "ConfigureAdmin", "Engineer",
                                          "Operator"};
        const std::uint8_t choice = script.byte();
        const char* const name = choice % 2 == 0 ? "ann" : "bob";
        const char* const role = roles[choice / 2 % roles.size()];
        const IdentityMappingRuleType rule{IdentityCriteriaType::UserName, String{name}};
        if (choice / 8 % 2 == 0) {
            static_cast<void>(world_.roles.add_identity(role, rule));
        } else {
            static_cast<void>(world_.roles.remove_identity(role, rule));
        }
        static_cast<void>(world_.files.take_changed());
        server::RunningServer{world_.server}.roles_changed();
        settle();
        check(late());
    }
    void write_setting(Actor& actor, fuzz::Script& script)
    {
        static constexpr std::array names{"limits.sessions", "users.anonymous"};
        const std::uint8_t choice = script.byte();
        WriteRequest request;
        WriteValue& item = request.nodes_to_write.emplace_back();
        item.node_id = NodeId{1, String{std::string{"Settings."} + names[choice % names.size()]}};
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.value.value = Variant{std::int64_t{choice}};
        ask(actor, std::move(request));
    }
    /// Into the temporary file that came last.
    void write_transferred(Actor& actor, fuzz::Script& script)
    {
        CallRequest request;
        CallMethodRequest& one = request.methods_to_call.emplace_back();
        one.object_id = world_.transferred;
        one.method_id = NodeId{1, String{world_.transferred.string().str() + "//Write"}};
        one.input_arguments = {Variant{world_.handles["transfers"]},
                               Variant{ByteString{script.bytes(script.byte() % 16U)}}};
        ask(actor, std::move(request));
    }
    void call(Actor& actor, fuzz::Script& script)
    {
        const fuzz::MethodTarget& target = world_.targets[script.byte() % world_.targets.size()];
        CallRequest request;
        CallMethodRequest& one = request.methods_to_call.emplace_back();
        one.object_id = target.object;
        one.method_id = target.method;
        for (const Argument& argument : target.inputs) {
            one.input_arguments.push_back(value(target, argument, script));
        }
        const std::vector<Asker> askers{world_.asker(actor.user())};
        ask(actor, std::move(request));
        const auto result = actor.result();
        if (result && result->status_code.is_good() && target.object.is(id::Server)) {
            require_right(Effect::State, askers); // what comes of it may come later
        }
        if (result && target.gives_handle) {
            world_.has_generated = true;
            for (const Variant& output : result->output_arguments) {
                if (const auto* const handle = output.get_if<std::uint32_t>()) {
                    world_.handles[counter_of(target.object)] = *handle;
                } else if (const auto* const file = output.get_if<NodeId>()) {
                    world_.transferred = *file;
                }
            }
        }
    }
    [[nodiscard]] Variant value(const fuzz::MethodTarget& target, const Argument& argument,
                                fuzz::Script& script)
    {
        if (argument.name.view().ends_with("Handle")) {
            return Variant{world_.handles[counter_of(target.object)] - script.byte() % 3U};
        }
        if (argument.name == "Names") {
            static constexpr std::array names{"limits.sessions", "users.anonymous"};
            return Variant{Array<String>{names[script.byte() % names.size()]}};
        }
        if (argument.data_type.is(id::ServerState)) {
            return Variant{std::int32_t{script.byte()} % 8};
        }
        if (argument.data_type.is(id::BaseDataType) && argument.value_rank >= 1) {
            return Variant{Array<Variant>{Variant{std::int64_t{script.byte()}}}};
        }
        if (argument.name.view().ends_with("Password")) {
            return script.byte() % 4 == 0 ? Variant{String{"other"}} : Variant{String{password}};
        }
        return fuzz::value_of(argument, script);
    }
    /// What counts the handles of the Object's files.
    [[nodiscard]] static std::string counter_of(const NodeId& object)
    {
        const std::string text = to_string(object);
        return text.find("Files/") != std::string::npos       ? "files"
               : text.find("Transfers/") != std::string::npos ? "transfers"
                                                              : text;
    }
    template <typename Request>
    void ask(Actor& actor, Request request)
    {
        auto askers = late();
        askers.push_back(world_.asker(actor.user()));
        world_.waiting.insert(actor.user());
        actor.send(std::move(request));
        settle();
        check(std::move(askers));
    }

    /// What Methods left for the server's thread.
    void settle()
    {
        do {
            world_.waker.is_awake = false;
            world_.server.handle_completions(world_.now);
            for (Actor& actor : actors_) {
                actor.run();
            }
        } while (world_.waker.is_awake);
    }
    /// Those whose Calls wait for others.
    [[nodiscard]] std::vector<Asker> late() const { return world_.askers_now(); }
    /// Each effect since the last check has somebody who may have it.
    void check(const std::vector<Asker>& askers)
    {
        bool has_files = false;
        for (const std::string& name : world_.files.take_changed()) {
            if (name.starts_with("recipes/")) {
                has_files = true;
                require_right(Effect::File, askers);
            } else if (name == "roles.json") {
                require_right(Effect::Role, askers);
            } else if (name == "users.json") {
                check_users(askers);
            } else if (name == "settings.json") {
                check_settings(askers);
            } else if (name.find("rejected/") == std::string::npos) {
                require_right(Effect::Certificates, askers);
            }
        }
        if (std::exchange(world_.transfers.has_taken, false)) {
            require_right(Effect::Transfer, askers);
        }
        before_ = world_.users.users();
        settings_before_ = world_.owner.applied;
        if (world_.worker.jobs.empty()) {
            world_.waiting.clear();
        }
        world_.open_new_channels(has_files);
    }
    void require_right(Effect effect, const std::vector<Asker>& askers,
                       const std::string& owner = {}) const
    {
        const auto wanted = roles_for(effect);
        fuzz::require(std::any_of(askers.begin(), askers.end(), [&](const Asker& asker) {
            return asker.has_one_of(wanted) || (!owner.empty() && asker.user == owner);
        }));
    }
    /// Somebody's own password is his to change, and nothing else.
    void check_users(const std::vector<Asker>& askers) const
    {
        const std::vector<administration::User> users = world_.users.users();
        const auto is_same = [](const administration::User& a, const administration::User& b) {
            constexpr std::uint32_t by_change = administration::user_bit::must_change_password;
            return a.name == b.name && a.description == b.description && a.roles == b.roles &&
                   (a.configuration | by_change) == (b.configuration | by_change);
        };
        if (!std::equal(users.begin(), users.end(), before_.begin(), before_.end(), is_same)) {
            require_right(Effect::User, askers);
            return;
        }
        for (std::size_t i = 0; i < users.size(); ++i) {
            if (users[i].password_hash != before_[i].password_hash) {
                require_right(Effect::Password, askers, users[i].name);
            }
        }
    }
    void check_settings(const std::vector<Asker>& askers) const
    {
        const auto of = [](const administration::SettingValues& values, const char* name) {
            const auto found = values.find(name);
            return found != values.end() ? found->second : Variant{};
        };
        const bool is_security =
            of(settings_before_, "users.anonymous") != of(world_.owner.applied, "users.anonymous");
        require_right(is_security ? Effect::SecuritySetting : Effect::Setting, askers);
    }
    /// False if something of the input stays.
    [[nodiscard]] bool restore()
    {
        world_.medium.set_protected(false);
        world_.kept_files.restore();
        auto& space = world_.server.address_space();
        for (const administration::RoleRules& each : world_.roles.roles()) {
            if (!administration::RoleList::is_well_known(each.name)) {
                static_cast<void>(space.remove(space.find(
                    NodeId{1, String{"RoleSet/" + each.namespace_uri + "/" + each.name}})));
            }
        }
        world_.owner.applied.clear();
        const bool is_loaded = world_.roles.load().has_value() && world_.users.load().has_value() &&
                               world_.settings.load().has_value();
        world_.administration.refresh_files();
        settle();
        world_.open_new_channels(true);
        static_cast<void>(world_.files.take_changed());
        return is_loaded;
    }
    /// Whoever comes next finds nothing taken: no file open, no transaction begun, no worker busy.
    [[nodiscard]] bool looks_unused()
    {
        Actor& chief = actors_[0];
        chief.log_in("chief", true);
        fuzz::require(!chief.user().empty());
        const auto call = [&](const NodeId& object, const NodeId& method,
                              std::vector<Variant> inputs) {
            CallRequest request;
            CallMethodRequest& one = request.methods_to_call.emplace_back();
            one.object_id = object;
            one.method_id = method;
            one.input_arguments = Array<Variant>{inputs};
            chief.send(std::move(request));
            settle();
            while (!world_.worker.jobs.empty()) {
                static_cast<void>(world_.worker.work());
                settle();
            }
            const auto result = chief.result();
            fuzz::require(result && !result->status_code.is_bad());
            return result->output_arguments.empty() ? Variant{} : result->output_arguments.back();
        };
        constexpr std::uint8_t writing = 6;
        const NodeId file{1, "Files/recipes/a"};
        call(file, NodeId{1, "FileTypes/recipes//Open"}, {Variant{writing}});
        const NodeId list{0, 12642};
        call(list, method_of(list, "Open"), {Variant{writing}});
        call(NodeId{1, "Transfers/backup"}, NodeId{1, "Transfers/backup//GenerateFileForWrite"},
             {Variant{}});
        const NodeId users{0, id::UserManagement};
        call(users, NodeId{0, id::UserManagement_AddUser},
             {Variant{"later"}, Variant{String{password}}, Variant{std::uint32_t{0}},
              Variant{String{}}});
        call(users, NodeId{0, id::UserManagement_RemoveUser}, {Variant{"later"}});
        chief.close();
        chief.leave();
        settle();
        static_cast<void>(world_.files.take_changed());
        return world_.server.session_count() == 0;
    }
    [[nodiscard]] NodeId method_of(const NodeId& object, const char* name) const
    {
        auto& space = world_.server.address_space();
        const auto found = fuzz::find_method(space, space.find(object), name);
        fuzz::require(found.has_value());
        return found->method;
    }

    World& world_;
    std::array<Actor, 2> actors_;
    /// At the last check.
    std::vector<administration::User> before_;
    administration::SettingValues settings_before_;
};

} // namespace

/// Two users of administration at once, who open, write, call and leave while their roles, accounts
/// and rules are changed by each other, Calls wait for the worker and time passes. Whatever changes
/// has somebody who had the right to it at that moment, and in the end nothing is taken.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static fuzz::KeptWorld<World> kept;
    Play play{kept.next()};
    play.run(fuzz::Script{{data, size}});
    if (!play.end()) {
        kept.drop();
    }
    return 0;
}

} // namespace rights_fuzz
