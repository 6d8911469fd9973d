"""Runs of scenarios of a campaign. The folder of a run belongs to one process at a time, and the file FOLDER.origin.json beside it says by which
commit and with which words the run was begun, so that no result of another commit or of other words is used."""
import fcntl
import json
import subprocess
from pathlib import Path

import tables


def origin_file(out):
    return out.with_name(f'{out.name}.origin.json')


def require_commit(args, out):
    """Ends the campaign if a folder of results was begun by another commit, unless --any-commit is set."""
    if args.any_commit or not out.exists():
        return
    found = json.loads(origin_file(out).read_text())['commit'] if origin_file(out).exists() else tables.UNKNOWN
    if found != tables.commit():
        raise SystemExit(f'{out}: expected results of commit {tables.commit()}, found those of commit {found}: remove the folder, choose another one '
                         'with --work, or use it with --any-commit')


def words_of(name, words):
    """What a run is made from: the program and its words without those that only say from where it goes on."""
    texts = [name, *map(str, words)]
    return [word for k, word in enumerate(texts) if '--resume' not in (word, texts[k - 1])]


def is_begun_with(out, name, words):
    """Whether the folder is that of a run of these words."""
    return origin_file(out).exists() and json.loads(origin_file(out).read_text())['words'] == words_of(name, words)


def resumed(args, words):
    """The folders of this campaign from which a run goes on."""
    for option, value in zip(words, words[1:]):
        if option == '--resume':
            path = Path(value)
            yield path if path.is_dir() else path.parent


def scenario(args, name, words, out, accepted=(0,)):
    """Runs a scenario, writes its output to OUT.log, and returns its exit code. Ends the campaign if it is none of `accepted`, or if another process
    is running in this folder."""
    out.parent.mkdir(parents=True, exist_ok=True)
    for folder in resumed(args, list(words)):
        require_commit(args, folder)
    with open(f'{out}.log', 'a') as log:
        try:
            fcntl.flock(log, fcntl.LOCK_EX | fcntl.LOCK_NB)  # the scenario inherits it, and keeps it if only the campaign is killed
        except BlockingIOError:
            raise SystemExit(f'{out}: expected a folder in which nothing runs, found one of another campaign (or of a scenario that has outlived it): wait for '
                             'its end, or choose another one with --work')
        log.truncate(0)
        (out / 'summary.json').unlink(missing_ok=True)
        origin_file(out).write_text(json.dumps({'commit': tables.commit(), 'words': words_of(name, words)}))
        command = [args.bin / name, '--quiet', '--threads', args.threads, *words, '--out', out]
        try:
            code = subprocess.run([str(word) for word in command], stdout=log, stderr=log).returncode
        except FileNotFoundError:
            raise SystemExit(f'{command[0]}: expected a program (build first, or give --bin), found none')
    if code not in accepted:
        said = Path(log.name).read_text(errors='replace').splitlines() or ['nothing was printed']
        raise SystemExit(f'{name} ended with code {code}: {said[-1]} ({log.name})')
    return code


def once(args, name, words, out):
    """The same unless the folder has the results of a complete run of these words; ends the campaign if they are of others, or of another commit."""
    if not (out / 'summary.json').exists():
        return scenario(args, name, words, out)
    require_commit(args, out)
    if origin_file(out).exists() and not is_begun_with(out, name, words):
        raise SystemExit(f'{out}: expected results of {" ".join(words_of(name, words))}, found those of other words ({origin_file(out)}): remove the folder, or '
                         'choose another one with --work')
    return 0
