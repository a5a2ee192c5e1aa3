#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"

namespace busbar::controller::detail {

bool DeclarationParser::read_configuration()
{
    std::string unused;
    if (!cursor_->expect_name(unused, "the name of the configuration")) {
        return false;
    }
    while (!cursor_->skip_word("END_CONFIGURATION")) {
        bool is_part = true;
        if (cursor_->skip_word("RESOURCE")) {
            if (!read_resource()) {
                return false;
            }
        } else if (!read_resource_part(is_part)) {
            return is_part ? false
                           : cursor_->fail("RESOURCE, VAR_GLOBAL, TASK, PROGRAM or "
                                           "END_CONFIGURATION");
        }
    }
    cursor_->skip_symbol(";");
    return true;
}

bool DeclarationParser::read_resource()
{
    std::string unused;
    if (!cursor_->expect_name(unused, "the name of the resource") || !cursor_->expect_word("ON") ||
        !cursor_->expect_name(unused, "the type of the resource")) {
        return false;
    }
    while (!cursor_->skip_word("END_RESOURCE")) {
        bool is_part = true;
        if (!read_resource_part(is_part)) {
            return is_part ? false : cursor_->fail("VAR_GLOBAL, TASK, PROGRAM or END_RESOURCE");
        }
    }
    cursor_->skip_symbol(";");
    return true;
}

bool DeclarationParser::read_resource_part(bool& is_part)
{
    std::optional<NetworkPublish> publish;
    if (!read_pragmas(publish)) {
        return false;
    }
    if (cursor_->skip_word("VAR_GLOBAL")) {
        return read_variables(publish.value_or(NetworkPublish::Hidden));
    }
    if (cursor_->skip_word("TASK")) {
        return read_task();
    }
    if (cursor_->skip_word("PROGRAM")) {
        return read_instance();
    }
    is_part = leaves_out_ && (cursor_->skip_word("VAR_ACCESS") || cursor_->skip_word("VAR_CONFIG"));
    return is_part && skip_variables();
}

bool DeclarationParser::read_task()
{
    ProgramTask task;
    if (!cursor_->keep(sizeof task) || !cursor_->expect_name(task.name, "the name of the task") ||
        !cursor_->expect_symbol("(")) {
        return false;
    }
    do {
        if (!read_task_setting(task)) {
            return false;
        }
    } while (cursor_->skip_symbol(","));
    if (!cursor_->skip_symbol(")")) {
        return cursor_->fail("',' or ')'");
    }
    program().tasks.push_back(std::move(task));
    return cursor_->expect_symbol(";");
}

bool DeclarationParser::read_task_setting(ProgramTask& task)
{
    if (cursor_->skip_word("INTERVAL")) {
        return cursor_->expect_symbol(":=") && read_interval(task);
    }
    if (cursor_->skip_word("PRIORITY")) {
        if (!cursor_->expect_symbol(":=")) {
            return false;
        }
        const DeclarationToken at = cursor_->now();
        std::int64_t priority = 0;
        if (!read_whole_number(*cursor_, priority, "a whole number")) {
            return false;
        }
        if (priority < 0 || priority > UINT32_MAX) {
            return cursor_->fail_at(at, "a priority of 32 bits without a sign");
        }
        task.priority = static_cast<std::uint32_t>(priority);
        return true;
    }
    // Reads what starts a task that is not cyclic; clients cannot see it.
    InitialValue unused;
    return (cursor_->skip_word("SINGLE") || cursor_->fail("SINGLE, INTERVAL or PRIORITY")) &&
           cursor_->expect_symbol(":=") && read_initial_value(*cursor_, unused);
}

bool DeclarationParser::read_interval(ProgramTask& task)
{
    const DeclarationToken at = cursor_->now();
    InitialValue value;
    if (at.kind != DeclarationToken::Kind::Typed || !read_initial_value(*cursor_, value) ||
        value.notation != InitialValue::Notation::Duration) {
        return cursor_->fail_at(at, "an interval as T#10ms");
    }
    task.interval = at.text;
    return cursor_->keep(task.interval.size());
}

bool DeclarationParser::read_instance()
{
    ProgramInstance instance;
    if (!cursor_->skip_word("RETAIN")) {
        cursor_->skip_word("NON_RETAIN");
    }
    if (!cursor_->keep(sizeof instance) ||
        !cursor_->expect_name(instance.name, "the name of the program")) {
        return false;
    }
    if (cursor_->skip_word("WITH") && !cursor_->expect_name(instance.task, "the name of a task")) {
        return false;
    }
    if (!cursor_->expect_symbol(":") ||
        !cursor_->expect_name(instance.type_name, "the type of the program") ||
        !skip_connections()) {
        return false;
    }
    program().instances.push_back(std::move(instance));
    return cursor_->expect_symbol(";");
}

bool DeclarationParser::skip_connections()
{
    std::size_t depth = 0;
    do {
        if (cursor_->is_symbol("(")) {
            ++depth;
        } else if (depth > 0 && cursor_->is_symbol(")")) {
            --depth;
        } else if (depth == 0) {
            return true;
        }
        if (cursor_->is_end() || cursor_->now().kind == DeclarationToken::Kind::Wrong) {
            return cursor_->fail("')'");
        }
        cursor_->take();
    } while (depth > 0);
    return true;
}

} // namespace busbar::controller::detail
