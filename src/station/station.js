'use strict';
/* An open page of the station: it shows if the station still confirms it, and, on Now, new results
 * as they come.
 *
 * The page is served grey (class `unconfirmed`) with the time of its content. It takes its
 * colours only while the station answers, and the time that counts is this clock's: a cable that
 * was pulled ends no connection. */
(function () {
  var BEAT_MS = 1000, ANSWER_MS = 2500, LOST_MS = 3500, LOOK_MS = 250, LOAD_MS = 15000, AGAIN_MS = 2000;
  var REFUSED_MAX = 2; /* a station that starts again refuses once or twice within a beat */
  var root = document.documentElement, silent = document.getElementById('silent');
  var started = Date.now(), heard = 0, answered = 0, refused = 0, beating = false, loading = false, again = false;
  var main = document.querySelector('main'), live = document.querySelector('[data-live]');
  var shown = main && main.dataset.news, known = main && main.dataset.at;

  function isRecent(since) {
    var age = Date.now() - since;
    return age >= 0 && age < LOST_MS; /* a clock that was set back gives no age */
  }

  /* Words stand in the page, in its language. */
  function wordOf(name, value) {
    var place = document.querySelector('[data-word=' + name + ']');
    return place ? place.textContent.replace('%', value) : '';
  }

  function sayLost(answers) {
    var words = wordOf(answers ? 'stale' : 'lost', known);
    if (silent.textContent !== words) silent.textContent = words; /* a screen reader says it once */
  }

  function show() {
    var confirmed = heard > 0 && refused < REFUSED_MAX && isRecent(heard);
    var lost = !confirmed && (refused >= REFUSED_MAX || !isRecent(heard || started));
    root.classList.toggle('unconfirmed', !confirmed);
    root.classList.toggle('asking', !confirmed && !lost);
    if (lost && silent) sayLost(refused < REFUSED_MAX && isRecent(answered));
    root.classList.toggle('lost', lost);
  }

  function fetchText(address, patience) {
    var stop = new AbortController(), clock = setTimeout(function () { stop.abort(); }, patience);
    return fetch(address, {credentials: 'same-origin', cache: 'no-store', signal: stop.signal})
      .then(function (answer) {
        if (!answer.ok) throw new Error('refused');
        return answer.text();
      }).finally(function () { clearTimeout(clock); });
  }

  /* An answer confirms the state of the time when the question was sent. It does not confirm a
   * page of older news: that is loaded again. */
  function beat() {
    var sent = Date.now();
    if (beating) return;
    beating = true;
    fetchText('/alive', ANSWER_MS).then(function (text) {
      var words = /^(\d+) (.+)\n$/.exec(text);
      if (!words) throw new Error('not the station');
      answered = sent;
      refused = 0;
      if (live && words[1] !== shown) {
        load();
        return;
      }
      heard = sent;
      known = words[2];
    }).catch(function () { refused++; }).finally(function () {
      beating = false;
      show();
    });
  }

  function isTyped(form) {
    return Array.prototype.some.call(form.elements, function (field) {
      return field.tagName === 'INPUT' && field.type !== 'hidden' && field.value !== field.defaultValue;
    });
  }

  /* A half-typed html form that leaves its place: names its foil, and the newer results. */
  function makeTyping(form, page) {
    var panel = document.createElement('div'), whose = document.createElement('p');
    var heading = page.querySelector('#foil' + form.dataset.foil);
    var drop = document.createElement('button');
    panel.className = 'typing';
    panel.dataset.after = page.querySelector('[data-arrival]').dataset.arrival;
    whose.innerHTML = (heading ? heading.innerHTML : '') + ' <span class="newer"></span>';
    drop.type = 'reset';
    drop.className = 'plain';
    drop.textContent = wordOf('drop');
    form.appendChild(drop);
    form.addEventListener('reset', function () { setTimeout(load, 0); });
    panel.append(whose, form);
    return panel;
  }

  function sayNewer(panel, next) {
    var words = Array.prototype.filter.call(next.querySelectorAll('[data-arrival]'), function (card) {
      return +card.dataset.arrival > +panel.dataset.after;
    }).map(function (card) { return card.dataset.words; });
    panel.querySelector('.newer').textContent = words.length ? wordOf('newer', words.length) + ' ' + words.join(', ') : '';
  }

  /* Keeps a half-typed form with its foil, also when newer ones fill the page. True: it has the
   * focus. */
  function keepTyped(page, next) {
    var at = document.activeElement, held = false;
    var from = at && at.selectionStart, to = at && at.selectionEnd;
    page.querySelectorAll('form[data-foil]').forEach(function (form) {
      if (!isTyped(form)) return;
      var home = next.querySelector('form[data-foil="' + form.dataset.foil + '"]');
      var panel = form.closest('.typing');
      form.elements.form.value = next.dataset.form;
      held = held || form.contains(at);
      if (home && !panel) {
        home.replaceWith(form);
      } else {
        if (home) home.remove();
        panel = panel || makeTyping(form, page);
        sayNewer(panel, next);
        next.querySelector('[data-typing]').append(panel);
      }
    });
    return held && function () {
      at.focus({preventScroll: true});
      if (from !== null && at.setSelectionRange) at.setSelectionRange(from, to);
    };
  }

  /* A screen reader speaks the new verdict, its file and the next step. */
  function tell(page) {
    var heard = document.getElementById('heard');
    if (heard) heard.textContent = Array.prototype.map.call(page.querySelectorAll('.call > *, .call + .next'),
      function (part) { return part.innerText || part.textContent; }).join('. ');
  }

  function wordsOfCall(page) {
    var call = page.querySelector('.call');
    return call ? call.textContent : '';
  }

  function put(text, sent) {
    var page = document.querySelector('main');
    var next = new DOMParser().parseFromString(text, 'text/html').querySelector('main');
    if (!page || !next || !next.dataset.news) return;
    next = document.importNode(next, true);
    var focus = keepTyped(page, next), other = wordsOfCall(page) !== wordsOfCall(next);
    page.replaceWith(next);
    live = next.querySelector('[data-live]');
    openScrolls();
    shown = next.dataset.news;
    known = next.dataset.at;
    heard = answered = sent;
    if (other) {
      window.scrollTo(0, 0);
      tell(next);
    }
    if (focus) focus();
    else takeFocus();
  }

  /* Loads one page at a time: of two that overtake each other the older would stay. */
  function load() {
    if (!live) return;
    again = loading;
    if (loading) return;
    loading = true;
    var sent = Date.now();
    fetchText(location.href, LOAD_MS).then(function (text) { put(text, sent); }).catch(function () {}).finally(function () {
      loading = false;
      if (again) load();
      again = false;
    });
  }

  /* Boxes that scroll take the focus, so that keys scroll them. */
  function openScrolls() {
    document.querySelectorAll('.scroll').forEach(function (box) {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
    });
  }

  /* A barcode reader types where the focus is, over the selection, and ends with Enter. */
  function takeFocus() {
    var field = document.querySelector('[data-focus]');
    if (!field) return;
    field.focus({preventScroll: true});
    field.select();
  }

  /* Listens for news; a beat with another count makes up for missed ones. */
  function listen() {
    var events = new EventSource('/events');
    events.onmessage = function (news) { if (news.lastEventId !== shown) load(); };
    events.onerror = function () {
      if (events.readyState === EventSource.CLOSED) setTimeout(listen, AGAIN_MS);
    };
  }

  /* A hidden page, or one back from the browser's memory, has not asked for a while: it has no
   * colours until the station answers, and is not called lost before the station had time to. */
  function wakeUp(event) {
    if (event && event.persisted) heard = 0;
    if (!isRecent(heard) && !root.classList.contains('lost')) {
      heard = 0;
      started = Date.now();
    }
    show();
    beat();
  }

  function turnPages(key) {
    var way = key.key === 'ArrowLeft' ? 'prev' : key.key === 'ArrowRight' ? 'next' : '', at = key.target.tagName;
    var link = way && document.querySelector('a[rel=' + way + ']');
    if (link && !key.altKey && !key.ctrlKey && !key.metaKey && at !== 'INPUT' && at !== 'SELECT') link.click();
  }

  if (live && window.EventSource) listen();
  takeFocus();
  openScrolls();
  document.addEventListener('keydown', turnPages);
  window.addEventListener('pageshow', wakeUp);
  document.addEventListener('visibilitychange', wakeUp);
  window.addEventListener('online', wakeUp);
  setInterval(beat, BEAT_MS);
  setInterval(show, LOOK_MS);
  wakeUp();
})();
