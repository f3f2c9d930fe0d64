// hivectl completion: prints the scripts that make a shell complete verbs, drones, ports and parameters.
#include "../verbs.hpp"

namespace hivectl::completion_verb {
namespace {

// All three scripts only call `hivectl complete`, so they need not know the verbs.
constexpr std::string_view bash_script = R"(# bash completion of hivectl; use it with: source <(hivectl completion bash)
_hivectl()
{
    local -a words=("${COMP_WORDS[@]:1:COMP_CWORD}")
    local last=$((COMP_CWORD - 1)) typed=""
    if [[ ${words[last]} == "=" ]]; then  # bash takes "key=value" for three words
        typed=${words[last-1]}=
        words=("${words[@]:0:last-1}" "$typed")
    elif ((last > 1)) && [[ ${words[last-1]} == "=" ]]; then
        typed=${words[last-2]}=
        words=("${words[@]:0:last-2}" "$typed${words[last]}")
    fi
    local IFS=$'\n'
    COMPREPLY=($(hivectl complete -- "${words[@]}" 2>/dev/null))
    COMPREPLY=("${COMPREPLY[@]#"$typed"}")
    [[ ${COMPREPLY[0]} == *[=.] ]] && compopt -o nospace
}
complete -o default -F _hivectl hivectl
)";

constexpr std::string_view zsh_script = R"(#compdef hivectl
# zsh completion of hivectl; use it with: source <(hivectl completion zsh)
_hivectl()
{
    local -a found open closed
    found=("${(@f)$(hivectl complete -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
    found=(${found:#})
    (( $#found )) || { _files; return }
    open=(${(M)found:#*[=.]})
    closed=(${found:#*[=.]})
    (( $#open )) && compadd -S '' -- $open
    (( $#closed )) && compadd -- $closed
}
compdef _hivectl hivectl
)";

constexpr std::string_view fish_script = R"(# fish completion of hivectl; use it with: hivectl completion fish | source
function __hivectl_complete
    set -l words (commandline -opc) (commandline -ct)
    hivectl complete -- $words[2..-1] 2>/dev/null
end
complete -c hivectl -a '(__hivectl_complete)'
)";

int run(const std::string& shell, Session& session)
{
    const std::string script(shell == "bash" ? bash_script : shell == "zsh" ? zsh_script : fish_script);
    write_out(session.json ? Row{{"shell", shell}, {"script", script}}.json() + "\n" : script);
    return exit_code::done;
}

void declare(CommandLine& line, std::string& shell)
{
    line.option("SHELL", shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
}

}  // namespace

Verb verb()
{
    return {.name = "completion",
            .group = "shell",
            .usage = "bash|zsh|fish",
            .summary = "Prints a script that completes verbs, live drones, ports and parameters",
            .examples = "source <(hivectl completion bash)",
            .operands = {Operand::other},
            .declare = with(declare, run)};
}

}  // namespace hivectl::completion_verb
